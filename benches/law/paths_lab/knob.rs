static mut V_PRESSED: f64 = 0.9; #[inline(always)] pub fn PRESSED() -> f64 { unsafe { V_PRESSED } }
static mut V_LEAST_NORMAL: f64 = 0.25; #[inline(always)] pub fn LEAST_NORMAL() -> f64 { unsafe { V_LEAST_NORMAL } }
static mut V_SUDDEN: f64 = 0.2; #[inline(always)] pub fn SUDDEN() -> f64 { unsafe { V_SUDDEN } }
static mut V_FORGETS: f64 = 4.0; #[inline(always)] pub fn FORGETS() -> f64 { unsafe { V_FORGETS } }
static mut V_GONE: f64 = 1e-5; #[inline(always)] pub fn GONE() -> f64 { unsafe { V_GONE } }
static mut V_RELAXATION: f64 = 0.1; #[inline(always)] pub fn RELAXATION() -> f64 { unsafe { V_RELAXATION } }
static mut V_EASED: f64 = 0.05; #[inline(always)] pub fn EASED() -> f64 { unsafe { V_EASED } }
static mut V_REVERSED: f64 = 0.05; #[inline(always)] pub fn REVERSED() -> f64 { unsafe { V_REVERSED } }
static mut V_GATHERED: f64 = 0.7; #[inline(always)] pub fn GATHERED() -> f64 { unsafe { V_GATHERED } }
static mut V_SLIDING: f64 = 0.98; #[inline(always)] pub fn SLIDING() -> f64 { unsafe { V_SLIDING } }
static mut V_MOST: f64 = 2.0; #[inline(always)] pub fn MOST() -> f64 { unsafe { V_MOST } }
static mut V_UNSHEARED: f64 = 1.8; #[inline(always)] pub fn UNSHEARED() -> f64 { unsafe { V_UNSHEARED } }
static mut V_SPARE: f64 = 5e-5; #[inline(always)] pub fn SPARE() -> f64 { unsafe { V_SPARE } }
static mut V_ROUNDING: f64 = 1e-9; #[inline(always)] pub fn ROUNDING() -> f64 { unsafe { V_ROUNDING } }
static mut V_PLASTIC_GAMMA: f64 = 1.2732395447351628; #[inline(always)] pub fn PLASTIC_GAMMA() -> f64 { unsafe { V_PLASTIC_GAMMA } }
static mut V_SPACING: f64 = 0.65; #[inline(always)] pub fn SPACING() -> f64 { unsafe { V_SPACING } }
pub fn set(name: &str, v: f64) { unsafe { match name {"PRESSED" => V_PRESSED = v, "LEAST_NORMAL" => V_LEAST_NORMAL = v, "SUDDEN" => V_SUDDEN = v, "FORGETS" => V_FORGETS = v, "GONE" => V_GONE = v, "RELAXATION" => V_RELAXATION = v, "EASED" => V_EASED = v, "REVERSED" => V_REVERSED = v, "GATHERED" => V_GATHERED = v, "SLIDING" => V_SLIDING = v, "MOST" => V_MOST = v, "UNSHEARED" => V_UNSHEARED = v, "SPARE" => V_SPARE = v, "ROUNDING" => V_ROUNDING = v, "PLASTIC_GAMMA" => V_PLASTIC_GAMMA = v, "SPACING" => V_SPACING = v, _ => panic!("{name}") } } }
