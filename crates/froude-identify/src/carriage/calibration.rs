//! placeholder
use super::run::Uncertain;
/// Newtons a volt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcePerVolt {
    /// Forward.
    pub force_per_volt_n: Uncertain,
}
