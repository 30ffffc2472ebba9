//! Which vector instructions rays are traced with.

/// Which instructions the walk is compiled for. Both give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// What every machine of the target has.
    Baseline,
    /// 256-bit vectors.
    Avx2,
}

impl Instructions {
    /// The fastest this machine has.
    pub fn detect() -> Instructions {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("bmi1") {
            return Instructions::Avx2;
        }
        Instructions::Baseline
    }
}
