//! χ² tests: directions are drawn with the density that is claimed.

use super::*;
use crate::math::stats::chi2_test;

const TAU: f64 = std::f64::consts::TAU;

/// Integral of the density over a cell of (z, φ) by bisecting until two Gauss rules agree.
fn integrate_cell(f: &dyn Fn(f64, f64) -> f64, z: (f64, f64), phi: (f64, f64), depth: u32) -> f64 {
    let gauss2 = |f: &dyn Fn(f64, f64) -> f64| {
        const X: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
        let mut sum = 0.0;
        for a in X {
            for b in X {
                sum += f(z.0 + a * (z.1 - z.0), phi.0 + b * (phi.1 - phi.0));
            }
        }
        sum * 0.25 * (z.1 - z.0) * (phi.1 - phi.0)
    };
    let mid = f((z.0 + z.1) * 0.5, (phi.0 + phi.1) * 0.5) * (z.1 - z.0) * (phi.1 - phi.0);
    let fine = gauss2(f);
    let settled = (fine - mid).abs() <= 0.003 * fine.abs() + 1e-9;
    if depth == 0 || (settled && depth < 11) {
        return fine;
    }
    let (zm, pm) = ((z.0 + z.1) * 0.5, (phi.0 + phi.1) * 0.5);
    [(z.0, zm), (zm, z.1)]
        .into_iter()
        .flat_map(|z| [(phi.0, pm), (pm, phi.1)].map(|phi| integrate_cell(f, z, phi, depth - 1)))
        .sum()
}

/// χ² of the directions drawn against the density claimed, delta lobes and misses as one more cell.
fn chi2_p(bsdf: &Bsdf, wo: Vec3, seed: u64) -> f64 {
    const ROWS: usize = 16;
    const COLUMNS: usize = 10;
    const N: usize = 30_000;
    let mut rng = Pcg::new(seed);
    let mut counts = vec![0.0; ROWS * COLUMNS + 1];
    for _ in 0..N {
        let cell = match bsdf.sample(wo, rng.next_vec2(), rng.next_f32()) {
            Some(s) if !s.delta => {
                let row = ((f64::from(s.wi.z) + 1.0) * 0.5 * ROWS as f64) as usize;
                let phi = f64::from(s.wi.y).atan2(f64::from(s.wi.x)).rem_euclid(TAU) / TAU;
                row.min(ROWS - 1) * COLUMNS + ((phi * COLUMNS as f64) as usize).min(COLUMNS - 1)
            }
            _ => ROWS * COLUMNS,
        };
        counts[cell] += 1.0;
    }
    let density = |z: f64, phi: f64| {
        let r = (1.0 - z * z).max(0.0).sqrt();
        let wi = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32);
        f64::from(bsdf.pdf(wo, wi))
    };
    let mut expected = Vec::new();
    for row in 0..ROWS {
        let z = |r: usize| r as f64 / ROWS as f64 * 2.0 - 1.0;
        for column in 0..COLUMNS {
            let phi = |c: usize| c as f64 / COLUMNS as f64 * TAU;
            let share = integrate_cell(&density, (z(row), z(row + 1)), (phi(column), phi(column + 1)), 14);
            expected.push(share * N as f64);
        }
    }
    let total: f64 = expected.iter().sum();
    assert!(
        total <= N as f64 * 1.01,
        "the density integrates to {}",
        total / N as f64
    );
    expected.push((N as f64 - total).max(0.0));
    chi2_test(&counts, &expected)
}

/// False alarm 1e-5 a case, seeds fixed.
#[test]
fn directions_have_the_density_claimed() {
    for (name, bsdf) in coloured() {
        if bsdf.is_delta_only() {
            continue;
        }
        for (i, cos) in [1.0, 0.7, 0.2, 0.02, -0.5].into_iter().enumerate() {
            let p = chi2_p(&bsdf, incidence(cos), 11 + i as u64);
            assert!(p > 1e-5, "{name} at cos {cos}: p = {p}");
        }
    }
}
