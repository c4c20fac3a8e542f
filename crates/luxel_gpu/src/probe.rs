//! The numerics probe (G07): what this device's arithmetic really does, in a few milliseconds at start-up.
//!
//! WGSL is fast-math by specification, so the kernels use only what the probe can check. Two kernels run
//! (`shaders/probe.wesl`): one measures accuracy over random operands, the other the special values. This twin judges them
//! against f64. The report goes into `luxel doctor` and into bug reports; [`NumericsReport::violations`] lists what our
//! kernels rely on and do not get, upon which the engine takes the CPU tracer.
//!
//! Rays against watertight geometry are no part of this room: the triangle kernel's owner runs them beside this probe.

use bytemuck::{Pod, Zeroable};

use crate::{
    FeatureSet, Frame, Gpu, GpuBuffer, GpuError, Kernel, NumericsReport, Overrides, PassTimes, PipelineCache,
    Resources, SelectsNan, Uniform,
};

const SAMPLES: u32 = 4096;
const LOOP_CAP: u32 = 1000;
const ACCURACY: Kernel = Kernel { module: "package::probe", entry: "accuracy", workgroup_size: [64, 1, 1] };
const SPECIAL_VALUES: Kernel =
    Kernel { module: "package::probe", entry: "special_values", workgroup_size: [1, 1, 1] };

const ONE: f32 = 1.0;
/// Small enough to vanish in 1 + tiny.
const TINY: f32 = f32::from_bits(0x3080_0000);
const NAN_BITS: u32 = 0x7fc0_0000;
const INFINITY_BITS: u32 = 0x7f80_0000;
const SUBNORMAL_BITS: u32 = 0x0010_0000;

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Operands {
    a: f32,
    b: f32,
    c: f32,
    bits: u32,
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Results {
    quotient: f32,
    reciprocal: f32,
    root: f32,
    inverse_root: f32,
    fused: f32,
    product_sum: f32,
    hash: u32,
    quotient_bits: u32,
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Specials {
    zero_bits: u32,
    nan_bits: u32,
    infinity_bits: u32,
    subnormal_bits: u32,
    min_normal: f32,
    large: f32,
    one: f32,
    tiny: f32,
    loop_cap: u32,
    pad: [u32; 3],
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Findings {
    nan_by_bits: u32,
    nan_unequal_itself: u32,
    nan_not_equal_itself: u32,
    min_nan_one: u32,
    min_one_nan: u32,
    max_nan_one: u32,
    max_one_nan: u32,
    infinity: u32,
    overflow: u32,
    infinity_less_infinity: u32,
    one_over_zero: u32,
    half_min_normal: u32,
    subnormal_sum: u32,
    two_sum: u32,
    two_sum_guarded: u32,
    loop_steps: u32,
}

/// Runs the probe; `pipelines` must be over a library with the module `package::probe`.
///
/// # Errors
/// Whatever the GPU gives: [`GpuError::Lost`], [`GpuError::Shader`], …
pub fn probe(gpu: &Gpu, pipelines: &mut PipelineCache) -> Result<NumericsReport, GpuError> {
    let operands = operands();
    let (results, accuracy_times) = run_accuracy(gpu, pipelines, &operands)?;
    let (findings, special_times) = run_specials(gpu, pipelines)?;
    Ok(judge(&operands, &results, &findings, accuracy_times.busy_ms() + special_times.busy_ms()))
}

fn run_accuracy(
    gpu: &Gpu,
    pipelines: &mut PipelineCache,
    operands: &[Operands],
) -> Result<(Vec<Results>, PassTimes), GpuError> {
    let pipeline = pipelines.get(gpu, &ACCURACY, &FeatureSet::default(), &Overrides::default())?;
    let given = GpuBuffer::from_slice(gpu, "operands", operands)?;
    let results = GpuBuffer::new(gpu, "results", u64::from(SAMPLES) * size_of::<Results>() as u64)?;
    let resources = Resources::new().buffer("operands", &given).buffer("results", &results);
    let bindings = pipeline.bind(gpu, &resources)?;
    let mut frame = Frame::new(gpu);
    frame.compute("probe accuracy", &pipeline, &bindings, [SAMPLES / ACCURACY.workgroup_size[0], 1, 1])?;
    let times = frame.submit()?.wait(gpu)?;
    Ok((results.read(gpu, 0, SAMPLES.into())?, times))
}

fn run_specials(gpu: &Gpu, pipelines: &mut PipelineCache) -> Result<(Findings, PassTimes), GpuError> {
    let pipeline = pipelines.get(gpu, &SPECIAL_VALUES, &FeatureSet::default(), &Overrides::default())?;
    let specials = Uniform::new(gpu, "specials", &specials())?;
    let findings = GpuBuffer::new(gpu, "findings", size_of::<Findings>() as u64)?;
    let resources = Resources::new().uniform("specials", &specials).buffer("findings", &findings);
    let bindings = pipeline.bind(gpu, &resources)?;
    let mut frame = Frame::new(gpu);
    frame.compute("probe special values", &pipeline, &bindings, [1, 1, 1])?;
    let times = frame.submit()?.wait(gpu)?;
    let found = findings.read(gpu, 0, 1)?.first().copied().unwrap_or_else(Findings::zeroed);
    Ok((found, times))
}

/// Operands of both signs of exponent, so that neither products nor quotients leave the normal range.
fn operands() -> Vec<Operands> {
    let operand = |index: u32| {
        let a = magnitude(pcg_hash(2 * index));
        let b = magnitude(pcg_hash(2 * index + 1));
        Operands { a, b, c: -(a * b), bits: pcg_hash(!index) }
    };
    (0..SAMPLES).map(operand).collect()
}

/// A float in 2⁻³² … 2³² with its mantissa and exponent from `bits`.
fn magnitude(bits: u32) -> f32 {
    let exponent = 127 - 32 + (bits >> 26);
    f32::from_bits((exponent << 23) | (bits & 0x007f_ffff))
}

fn specials() -> Specials {
    Specials {
        zero_bits: 0,
        nan_bits: NAN_BITS,
        infinity_bits: INFINITY_BITS,
        subnormal_bits: SUBNORMAL_BITS,
        min_normal: f32::MIN_POSITIVE,
        large: f32::MAX,
        one: ONE,
        tiny: TINY,
        loop_cap: LOOP_CAP,
        pad: [0; 3],
    }
}

/// Twin of the shader's `pcg_hash` (Jarzynski and Olano 2020).
fn pcg_hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Distance of `found` from `exact` in units in the last place of `exact`, a normal f32 value.
fn error_ulp(found: f32, exact: f64) -> f64 {
    // Precision of f32: 24 bits.
    let ulp = 2_f64.powi(exact.abs().log2().floor() as i32 - 23);
    let error = (f64::from(found) - exact).abs() / ulp;
    if error.is_finite() { error } else { f64::MAX }
}

fn judge(operands: &[Operands], results: &[Results], findings: &Findings, kernel_ms: f64) -> NumericsReport {
    let pairs = || operands.iter().zip(results);
    let worst = |error: fn(&Operands, &Results) -> f64| pairs().map(|(o, r)| error(o, r)).fold(0.0, f64::max);
    let complete = operands.len() == results.len();
    let [found_one, found_infinity] = [ONE.to_bits(), INFINITY_BITS];
    let selects = |bits: u32| match bits {
        _ if bits == found_one => SelectsNan::Number,
        _ if is_nan_bits(bits) => SelectsNan::Nan,
        _ => SelectsNan::Other,
    };
    let min_max = [findings.min_nan_one, findings.min_one_nan, findings.max_nan_one, findings.max_one_nan];
    NumericsReport {
        fma_is_fused: pairs().any(|(_, r)| r.fused != 0.0),
        sums_are_contracted: pairs().any(|(_, r)| r.product_sum != 0.0),
        division_ulp: worst(|o, r| error_ulp(r.quotient, f64::from(o.a) / f64::from(o.b))),
        reciprocal_ulp: worst(|o, r| error_ulp(r.reciprocal, 1.0 / f64::from(o.b))),
        root_ulp: worst(|o, r| error_ulp(r.root, f64::from(o.a).sqrt())),
        inverse_root_ulp: worst(|o, r| error_ulp(r.inverse_root, 1.0 / f64::from(o.a).sqrt())),
        subnormals_kept: findings.half_min_normal == f32::MIN_POSITIVE.to_bits() >> 1
            && findings.subnormal_sum == 2 * SUBNORMAL_BITS,
        nan_found_by_bits: findings.nan_by_bits == 1,
        nan_unequal_itself: findings.nan_unequal_itself == 1,
        nan_not_equal_itself: findings.nan_not_equal_itself == 1,
        min_max_with_nan: min_max.map(selects),
        infinity_kept: findings.infinity == found_infinity,
        overflow_is_infinity: findings.overflow == found_infinity,
        infinity_less_infinity_is_nan: is_nan_bits(findings.infinity_less_infinity),
        division_by_zero_is_infinity: findings.one_over_zero == found_infinity,
        two_sum_survives: findings.two_sum == TINY.to_bits(),
        guarded_two_sum_survives: findings.two_sum_guarded == TINY.to_bits(),
        integers_exact: complete
            && pairs()
                .all(|(o, r)| r.hash == pcg_hash(o.bits) && r.quotient_bits == o.bits / ((o.bits >> 16) | 1)),
        loop_caps_hold: findings.loop_steps == LOOP_CAP,
        kernel_ms,
    }
}

fn is_nan_bits(bits: u32) -> bool {
    bits & 0x7fff_ffff > 0x7f80_0000
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LinkedShader, ShaderLibrary};

    /// What a device with IEEE arithmetic, unfused, would give.
    fn ideal() -> (Vec<Operands>, Vec<Results>, Findings) {
        let operands = operands();
        let result = |o: &Operands| Results {
            quotient: o.a / o.b,
            reciprocal: 1.0 / o.b,
            root: o.a.sqrt(),
            inverse_root: (1.0 / f64::from(o.a).sqrt()) as f32,
            fused: o.a.mul_add(o.b, o.c),
            product_sum: o.a * o.b + o.c,
            hash: pcg_hash(o.bits),
            quotient_bits: o.bits / ((o.bits >> 16) | 1),
        };
        let results = operands.iter().map(result).collect();
        let findings = Findings {
            nan_by_bits: 1,
            nan_unequal_itself: 1,
            nan_not_equal_itself: 1,
            min_nan_one: ONE.to_bits(),
            min_one_nan: ONE.to_bits(),
            max_nan_one: ONE.to_bits(),
            max_one_nan: NAN_BITS,
            infinity: INFINITY_BITS,
            overflow: INFINITY_BITS,
            infinity_less_infinity: NAN_BITS,
            one_over_zero: INFINITY_BITS,
            half_min_normal: 0x0040_0000,
            subnormal_sum: 2 * SUBNORMAL_BITS,
            two_sum: TINY.to_bits(),
            two_sum_guarded: TINY.to_bits(),
            loop_steps: LOOP_CAP,
        };
        (operands, results, findings)
    }

    #[test]
    fn an_ideal_device_is_sound() {
        let (operands, results, findings) = ideal();
        let report = judge(&operands, &results, &findings, 1.0);
        assert_eq!(report.violations(), [""; 0]);
        assert!(report.fma_is_fused && !report.sums_are_contracted);
        assert!(report.division_ulp <= 0.5 && report.root_ulp <= 0.5);
        assert!(report.subnormals_kept && report.two_sum_survives && report.infinity_kept);
        assert_eq!(report.min_max_with_nan[2..], [SelectsNan::Number, SelectsNan::Nan]);
    }

    /// Each fault, put into one of 4096 results or one finding, is found.
    #[test]
    fn every_fault_is_a_violation() {
        type Fault = fn(&mut Vec<Results>, &mut Findings);
        let faults: [(&str, Fault); 9] = [
            ("division", |r, _| r[77].quotient = f32::from_bits(r[77].quotient.to_bits() + 4)),
            ("reciprocal", |r, _| r[78].reciprocal = f32::NAN),
            ("sqrt", |r, _| r[79].root = 0.0),
            ("inverseSqrt", |r, _| r[80].inverse_root = f32::INFINITY),
            ("integer", |r, _| r[81].hash ^= 1),
            ("integer", |r, _| r[82].quotient_bits ^= 1),
            ("integer", |r, _| r.truncate(4000)),
            ("NaN", |_, f| f.nan_by_bits = 0),
            ("loop", |_, f| f.loop_steps += 1),
        ];
        for (name, fault) in faults {
            let (operands, mut results, mut findings) = ideal();
            fault(&mut results, &mut findings);
            let violations = judge(&operands, &results, &findings, 1.0).violations();
            assert!(violations.len() == 1 && violations[0].contains(name), "{name}: {violations:?}");
        }
    }

    #[test]
    fn records_lie_as_the_shader_says() {
        let link = |kernel| ShaderLibrary::embedded().link(kernel, &FeatureSet::default()).unwrap();
        let check = |shader: &LinkedShader, name: &str, bytes: usize| {
            let layout = shader.layout(name).unwrap();
            assert_eq!(layout.size as usize, bytes, "{name}");
            // All members are single words, in order.
            assert!(layout.members.iter().zip(0..).all(|(member, i)| member.offset == 4 * i), "{name}");
        };
        let accuracy = link(&ACCURACY);
        check(&accuracy, "Operands", size_of::<Operands>());
        check(&accuracy, "Results", size_of::<Results>());
        let special_values = link(&SPECIAL_VALUES);
        check(&special_values, "Specials", size_of::<Specials>());
        check(&special_values, "Findings", size_of::<Findings>());
    }
}
