//! Messages between host and carriage controller.
#![no_std]
