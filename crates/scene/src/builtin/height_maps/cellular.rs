//! Reliefs of single things, one to a cell of a grid.

use super::noise::{gradient_noise, random};
use super::smooth_step;

/// Columns of a quarter of a cell's width in radius, whose walls are a texel and a half wide at the
/// map's own size: bilinear heights have no steeper ones without steps along the rim.
pub(super) fn cylinders(x: f64, y: f64, _texels: u32) -> f64 {
    const CELLS: f64 = 4.0;
    const WALL: f64 = 1.5 / 32.0;
    let [x, y] = [x, y].map(|t| (t * CELLS).fract() - 0.5);
    ((0.25 + WALL / 2.0 - x.hypot(y)) / WALL).clamp(0.0, 1.0)
}

/// Scales around jittered points in staggered rows, each with a keel along v and a grain.
pub(super) fn reptile_skin(x: f64, y: f64, _texels: u32) -> f64 {
    const CELLS: [u32; 2] = [14, 16];
    let mut nearest = (f64::INFINITY, 0.0, 0.0);
    let mut second = f64::INFINITY;
    for_cells(x, y, CELLS, 2, |at, dx, dy| {
        let stagger = if at[1] % 2 == 0 { 0.25 } else { -0.25 };
        let dx = dx - stagger - 0.36 * (random(at, 41, 0) - 0.5);
        let dy = dy - 0.36 * (random(at, 41, 1) - 0.5);
        let distance = dx.hypot(dy);
        if distance < nearest.0 {
            second = nearest.0;
            nearest = (distance, dx, 0.85 + 0.15 * random(at, 41, 2));
        } else {
            second = second.min(distance);
        }
    });
    let (distance, across, height) = nearest;
    let from_border = ((second - distance) / 0.6).min(1.0);
    let scale = 1.0 - (1.0 - from_border).powi(2);
    let keel = smooth_step(0.18, 0.0, across.abs());
    let grain = gradient_noise(x, y, 64, 42);
    height * (scale * (0.8 + 0.2 * keel) + 0.05 * grain * from_border)
}

/// Bowls with raised rims, of six sizes, over slightly uneven ground. Depth and rim are in proportion
/// to the radius, as those of young craters are.
pub(super) fn craters(x: f64, y: f64, _texels: u32) -> f64 {
    let mut height = 0.012 * gradient_noise(x, y, 4, 52) + 0.004 * gradient_noise(x, y, 16, 53);
    for (seed, cells) in [2, 4, 7, 13, 25, 47].into_iter().enumerate() {
        for_cells(x, y, [cells; 2], 1, |at, dx, dy| {
            let random = |which: u32| random(at, 54 + seed as u32, which);
            if random(0) < 0.75 {
                let distance = (dx - 0.5 * (random(1) - 0.5)).hypot(dy - 0.5 * (random(2) - 0.5));
                let radius = 0.16 + 0.24 * random(3) * random(4);
                height += radius / f64::from(cells) * crater(distance / radius);
            }
        });
    }
    height
}

/// A crater of radius 1 at a distance from its middle.
fn crater(distance: f64) -> f64 {
    const RIM: f64 = 0.09;
    const FLOOR: f64 = -0.26;
    if distance < 1.0 {
        return (RIM + 0.42 * (distance * distance - 1.0)).max(FLOOR);
    }
    // What was thrown out lies up to another radius away.
    let fade = smooth_step(2.0, 1.0, distance);
    RIM * fade / distance.powi(3)
}

/// Calls `visit` with each cell within `reach` cells around a point: its column and row, and the
/// point's place in cells against the middle of the cell.
fn for_cells(x: f64, y: f64, cells: [u32; 2], reach: i64, mut visit: impl FnMut([u32; 2], f64, f64)) {
    let place = [x * f64::from(cells[0]), y * f64::from(cells[1])];
    let own = place.map(|t| t.floor() as i64);
    for row in own[1] - reach..=own[1] + reach {
        for column in own[0] - reach..=own[0] + reach {
            let at =
                [column.rem_euclid(i64::from(cells[0])) as u32, row.rem_euclid(i64::from(cells[1])) as u32];
            visit(at, place[0] - column as f64 - 0.5, place[1] - row as f64 - 0.5);
        }
    }
}
