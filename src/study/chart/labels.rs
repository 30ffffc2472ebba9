//! Places for words beside the things they name, such that nothing overlaps.

use super::shapes::{Anchor, At, Room, Text};

/// What is already on a panel.
#[derive(Clone, Debug)]
pub struct Labels {
    /// Where words may stand.
    pub bounds: Room,
    taken: Vec<Room>,
    lines: Vec<[At; 2]>,
}

/// Space that words keep from other words.
const GAP: f64 = 1.5;

impl Labels {
    pub fn new(bounds: Room) -> Self {
        Self {
            bounds,
            taken: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Marks a room as taken.
    pub fn take(&mut self, room: Room) {
        self.taken.push(room);
    }

    /// Marks a line as drawn.
    pub fn cross(&mut self, points: &[At]) {
        self.lines.extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
    }

    /// Whether words in this room would touch nothing.
    fn is_free(&self, room: &Room) -> bool {
        let wide = Room::new(room.min.map(|v| v - GAP), room.max.map(|v| v + GAP));
        self.bounds.holds(room)
            && !self.taken.iter().any(|other| wide.meets(other))
            && !self.lines.iter().any(|[a, b]| room.meets_segment(*a, *b))
    }

    /// The text at the first of the places where it touches nothing; that room is then taken.
    pub fn place(&mut self, text: &Text, places: &[(At, Anchor)]) -> Option<Text> {
        let placed = places
            .iter()
            .map(|(at, anchor)| Text {
                at: *at,
                anchor: *anchor,
                ..text.clone()
            })
            .find(|text| self.is_free(&text.room()))?;
        self.take(placed.room());
        Some(placed)
    }
}

/// Places around a marker, the best first: upper right, lower left, above, below, right, left, and the same farther.
pub fn around([x, y]: At, radius: f64, size: f64) -> Vec<(At, Anchor)> {
    let (rise, drop) = (0.24 * size, 0.78 * size);
    let ring = |d: f64| {
        let side = 0.5 * (drop - rise);
        [
            ([x + 0.7 * d, y - 0.7 * d - rise], Anchor::Start),
            ([x - 0.7 * d, y + 0.7 * d + drop], Anchor::End),
            ([x, y - d - rise], Anchor::Middle),
            ([x, y + d + drop], Anchor::Middle),
            ([x + d + 2.0, y + side], Anchor::Start),
            ([x - d - 2.0, y + side], Anchor::End),
            ([x + 0.7 * d, y + 0.7 * d + drop], Anchor::Start),
            ([x - 0.7 * d, y - 0.7 * d - rise], Anchor::End),
        ]
    };
    [3.0, 8.0].into_iter().flat_map(|more| ring(radius + more)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_avoid_words_lines_and_the_edge() {
        let mut labels = Labels::new(Room::new([0.0, 0.0], [100.0, 100.0]));
        labels.cross(&[[0.0, 0.0], [100.0, 100.0]]);
        let mut rooms: Vec<Room> = Vec::new();
        for i in 1..10 {
            let at = [10.0 * f64::from(i); 2];
            if let Some(text) = labels.place(&Text::new("64", [0.0; 2], 12.0), &around(at, 4.0, 12.0)) {
                rooms.push(text.room());
            }
        }
        assert!(rooms.len() >= 5, "{}", rooms.len());
        for (i, room) in rooms.iter().enumerate() {
            assert!(labels.bounds.holds(room));
            assert!(!room.meets_segment([0.0, 0.0], [100.0, 100.0]));
            assert!(!rooms[..i].iter().any(|other| room.meets(other)));
        }
        let full = labels.place(
            &Text::new("far too long for the room", [0.0; 2], 12.0),
            &around([50.0; 2], 4.0, 12.0),
        );
        assert_eq!(full, None);
    }
}
