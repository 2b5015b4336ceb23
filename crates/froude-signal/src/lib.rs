//! Filters, decimation, spectra and autocorrelation of uniformly sampled records.
