//! A way through a medium: how far light comes before it is scattered.

use super::Medium;
use crate::math::portable::ln;
use glam::Vec3;

/// What happens on a way through a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Passage {
    /// The path reaches the end of its way with this factor on its throughput.
    Through(Vec3),
    /// It is scattered at this distance, with this factor; what the phase function does is not in it.
    Scattered(f32, Vec3),
}

/// Decides whether a path is scattered before `distance` (may be infinite) in a medium. `u` and `u_channel` are in
/// [0, 1); `throughput` is what the path carries: the channel that decides how far it goes is chosen by it.
///
/// Each channel has its own density of distances; the factor is divided by that of all of them together, so that no
/// channel is divided by next to nothing however different they are. Light that is absorbed rather than scattered is
/// lost in the factor: a path is not ended here. A medium that does not scatter gives its transmittance.
/// Source: one-sample multiple importance sampling with the balance heuristic, Veach 1997.
#[inline]
pub fn passage(medium: &Medium, distance: f32, throughput: Vec3, u: f32, u_channel: f32) -> Passage {
    if !medium.scatters() {
        return Passage::Through(medium.transmittance(distance));
    }
    let carried = throughput.max(Vec3::ZERO).to_array();
    let sum: f32 = carried.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return Passage::Through(medium.transmittance(distance));
    }
    let share = carried.map(|c| c / sum);
    let mut channel = 0;
    let mut left = u_channel;
    while channel < 2 && left >= share[channel] {
        left -= share[channel];
        channel += 1;
    }
    // Rounding may lead to a channel of no share behind the last that has one.
    while share[channel] == 0.0 && channel > 0 {
        channel -= 1;
    }
    let sigma = medium.extinction.to_array();
    let share = Vec3::from_array(share);
    // u is below 1, so that the logarithm is finite. A clear channel always comes through.
    let t = if sigma[channel] > 0.0 {
        -ln(1.0 - u) / sigma[channel]
    } else {
        f32::INFINITY
    };
    if t < distance {
        let left = medium.transmittance(t);
        let density = share.dot(medium.extinction * left);
        return Passage::Scattered(t, medium.scattering * left / density);
    }
    let left = medium.transmittance(distance);
    Passage::Through(left / share.dot(left))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::medium::Medium;

    fn medium(extinction: [f32; 3], scattering: [f32; 3]) -> Medium {
        Medium {
            extinction: extinction.into(),
            scattering: scattering.into(),
            ..Medium::CLEAR
        }
    }

    /// Factors in the mean, per channel: through it is the transmittance, scattered it is (σs/σt)·(1 − transmittance);
    /// whatever the path carries and however different the channels are. 2²⁰ stratified pairs of numbers: the error of
    /// such a mean, for a bounded function of two numbers, is below 3 steps of 2⁻¹⁰ times the bound of the factor (3).
    #[test]
    fn the_mean_is_what_beer_and_lambert_say() {
        let media = [
            medium([1.0; 3], [1.0; 3]),
            medium([2.0, 0.5, 0.1], [1.0, 0.5, 0.0]),
            medium([1000.0, 1.0, 0.0], [900.0, 0.2, 0.0]),
            medium([0.0, 0.0, 3.0], [0.0, 0.0, 3.0]),
        ];
        for m in media {
            for carried in [Vec3::ONE, Vec3::new(1.0, 0.1, 0.3), Vec3::new(0.0, 2.0, 1.0)] {
                for distance in [0.01, 1.0, 40.0, f32::INFINITY] {
                    let n = 1024;
                    let (mut through, mut scattered) = (glam::DVec3::ZERO, glam::DVec3::ZERO);
                    for i in 0..n * n {
                        let u = |k: i32| (k as f32 + 0.5) / n as f32;
                        match passage(&m, distance, carried, u(i / n), u(i % n)) {
                            Passage::Through(f) => through += (f * carried).as_dvec3(),
                            Passage::Scattered(t, f) => {
                                assert!(t >= 0.0 && t < distance);
                                scattered += (f * carried).as_dvec3();
                            }
                        }
                    }
                    let count = f64::from(n) * f64::from(n);
                    let (through, scattered) = (through / count, scattered / count);
                    for c in 0..3 {
                        let (s, depth) = (
                            f64::from(m.extinction[c]),
                            f64::from(m.extinction[c]) * f64::from(distance),
                        );
                        let left = if s == 0.0 { 1.0 } else { (-depth).exp() };
                        let albedo = if s == 0.0 { 0.0 } else { f64::from(m.scattering[c]) / s };
                        let share = f64::from(carried[c]);
                        let allowed = 9.0 / f64::from(n) * f64::from(carried.element_sum());
                        let off = (through[c] - share * left).abs();
                        assert!(off < allowed, "{m:?}, {distance}, channel {c}: {} through", through[c]);
                        let off = (scattered[c] - share * albedo * (1.0 - left)).abs();
                        assert!(
                            off < allowed,
                            "{m:?}, {distance}, channel {c}: {} scattered",
                            scattered[c]
                        );
                    }
                }
            }
        }
    }

    /// What is clear changes nothing, bit for bit; what only absorbs decides nothing.
    #[test]
    fn clear_and_black_media_need_no_chance() {
        for u in [0.0, 0.5, 0.999_999_9] {
            let carried = Vec3::new(0.3, 0.2, 0.1);
            assert_eq!(
                passage(&Medium::CLEAR, f32::INFINITY, carried, u, u),
                Passage::Through(Vec3::ONE)
            );
            let ink = Medium::absorbing(Vec3::new(1.0, 2.0, 0.0));
            assert_eq!(
                passage(&ink, 2.0, carried, u, u),
                Passage::Through(ink.transmittance(2.0))
            );
        }
    }
}
