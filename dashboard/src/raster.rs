//! What the window shows as pixels, without window, graphics card or display.

use std::collections::HashMap;

use egui::epaint::{ClippedPrimitive, ImageData, Mesh, Primitive, TextureId, textures::TexturesDelta};
use egui::{Color32, ColorImage, Pos2, Rect};

/// Triangles to pixels, as `egui_glow` has its graphics card do it: colour of the texture times colour of the vertex,
/// both premultiplied by alpha and in gamma space, blended over what is there.
#[derive(Debug, Default)]
pub struct Raster {
    textures: HashMap<TextureId, ColorImage>,
}

impl Raster {
    /// Takes new and changed textures: the letters.
    pub fn update(&mut self, delta: &TexturesDelta) {
        for (id, changes) in &delta.set {
            for change in changes {
                let ImageData::Color(image) = &change.image;
                match (change.pos, self.textures.get_mut(id)) {
                    (Some([left, top]), Some(whole)) => paste(whole, image, left, top),
                    _ => {
                        self.textures.insert(*id, image.as_ref().clone());
                    }
                }
            }
        }
        for id in &delta.free {
            self.textures.remove(id);
        }
    }

    /// Draws primitives on a picture of `size` pixels with this background; one point is `scale` pixels.
    pub fn draw(
        &self,
        primitives: &[ClippedPrimitive],
        size: [usize; 2],
        scale: f32,
        background: Color32,
    ) -> ColorImage {
        let mut picture = ColorImage::filled(size, background);
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            // Callbacks draw with a graphics card; there is none.
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = self.textures.get(&mesh.texture_id) else { continue };
            let pixels = |value: f32, most: usize| (value * scale).round().clamp(0.0, most as f32) as usize;
            let clip = [
                pixels(clip_rect.min.x, size[0]),
                pixels(clip_rect.min.y, size[1]),
                pixels(clip_rect.max.x, size[0]),
                pixels(clip_rect.max.y, size[1]),
            ];
            for triangle in mesh.indices.chunks_exact(3) {
                fill(&mut picture, mesh, triangle, texture, clip, scale);
            }
        }
        picture
    }
}

fn paste(whole: &mut ColorImage, patch: &ColorImage, left: usize, top: usize) {
    for y in 0..patch.size[1] {
        let (from, to) = (y * patch.size[0], (top + y) * whole.size[0] + left);
        whole.pixels[to..to + patch.size[0]].copy_from_slice(&patch.pixels[from..from + patch.size[0]]);
    }
}

/// Fills the pixels whose middle lies in a triangle, clipped to `[left, top, right, bottom]`.
fn fill(
    picture: &mut ColorImage,
    mesh: &Mesh,
    triangle: &[u32],
    texture: &ColorImage,
    [left, top, right, bottom]: [usize; 4],
    scale: f32,
) {
    let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[triangle[k] as usize]);
    let [pa, pb, pc] = [a, b, c].map(|vertex| (vertex.pos.to_vec2() * scale).to_pos2());
    let area = cross(pa, pb, pc);
    let bounds = Rect::from_points(&[pa, pb, pc]);
    if area == 0.0 || !bounds.is_finite() {
        return;
    }
    let first = |value: f32, least: usize| (value - 0.5).ceil().max(least as f32) as usize;
    let last = |value: f32, most: usize| ((value - 0.5).floor() + 1.0).clamp(0.0, most as f32) as usize;
    let width = picture.size[0];
    let one_colour = a.color == b.color && b.color == c.color;
    let one_texel = a.uv == b.uv && b.uv == c.uv;
    let solid = (one_colour && one_texel).then(|| times(a.color.to_array(), sample(texture, a.uv)));
    for y in first(bounds.min.y, top)..last(bounds.max.y, bottom) {
        for x in first(bounds.min.x, left)..last(bounds.max.x, right) {
            let at = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
            let weights = [cross(pb, pc, at), cross(pc, pa, at), cross(pa, pb, at)].map(|part| part / area);
            // Of an edge that two triangles share, one of them has the pixels exactly on it.
            let inside = weights
                .iter()
                .zip([(pb, pc), (pc, pa), (pa, pb)])
                .all(|(weight, (from, to))| *weight > 0.0 || (*weight == 0.0 && owns_edge(from, to, area)));
            if !inside {
                continue;
            }
            let source = solid.unwrap_or_else(|| {
                let mix = |of: fn(&egui::epaint::Vertex) -> [f32; 4]| -> [f32; 4] {
                    let [a, b, c] = [of(&a), of(&b), of(&c)];
                    std::array::from_fn(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k])
                };
                let uv = mix(|vertex| [vertex.uv.x, vertex.uv.y, 0.0, 0.0]);
                let colour = mix(|vertex| vertex.color.to_array().map(f32::from));
                times(colour.map(|value| value.round() as u8), sample(texture, Pos2::new(uv[0], uv[1])))
            });
            let pixel = &mut picture.pixels[y * width + x];
            *pixel = over(source, *pixel);
        }
    }
}

fn cross(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The top-left rule.
fn owns_edge(from: Pos2, to: Pos2, area: f32) -> bool {
    let (dx, dy) = if area > 0.0 { (to.x - from.x, to.y - from.y) } else { (from.x - to.x, from.y - to.y) };
    dy < 0.0 || (dy == 0.0 && dx > 0.0)
}

/// Bilinear sample, edges held.
fn sample(texture: &ColorImage, uv: Pos2) -> [f32; 4] {
    let [width, height] = texture.size;
    let (x, y) = (uv.x * width as f32 - 0.5, uv.y * height as f32 - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let texel = |dx: f32, dy: f32| -> [f32; 4] {
        let column = (x.floor() + dx).clamp(0.0, width as f32 - 1.0) as usize;
        let row = (y.floor() + dy).clamp(0.0, height as f32 - 1.0) as usize;
        texture.pixels[row * width + column].to_array().map(f32::from)
    };
    let [a, b, c, d] = [texel(0.0, 0.0), texel(1.0, 0.0), texel(0.0, 1.0), texel(1.0, 1.0)];
    std::array::from_fn(|k| (a[k] * (1.0 - fx) + b[k] * fx) * (1.0 - fy) + (c[k] * (1.0 - fx) + d[k] * fx) * fy)
}

fn times(colour: [u8; 4], texel: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|k| f32::from(colour[k]) * texel[k] / 255.0)
}

/// Premultiplied source over an opaque pixel.
fn over(source: [f32; 4], below: Color32) -> Color32 {
    let below = below.to_array();
    let through = 1.0 - source[3] / 255.0;
    let [red, green, blue, alpha] =
        std::array::from_fn(|k| (source[k] + through * f32::from(below[k])).round().clamp(0.0, 255.0) as u8);
    Color32::from_rgba_premultiplied(red, green, blue, alpha)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::epaint::Vertex;

    fn raster() -> Raster {
        let textures = HashMap::from([(TextureId::default(), ColorImage::filled([1, 1], Color32::WHITE))]);
        Raster { textures }
    }

    fn mesh(corners: &[[f32; 2]], indices: &[u32], colour: Color32) -> ClippedPrimitive {
        let vertices =
            corners.iter().map(|[x, y]| Vertex { pos: Pos2::new(*x, *y), uv: Pos2::ZERO, color: colour }).collect();
        let mesh = Mesh { indices: indices.to_vec(), vertices, texture_id: TextureId::default() };
        let clip_rect = Rect::from_min_size(Pos2::ZERO, egui::vec2(20.0, 9.0));
        ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) }
    }

    /// Two half-transparent triangles of one square: every pixel inside is covered exactly once, none outside; what
    /// lies beyond the clip stays as it was.
    #[test]
    fn a_square_has_no_seam() {
        let half = Color32::from_rgba_premultiplied(100, 0, 0, 128);
        let square = mesh(&[[2.0, 3.0], [12.0, 3.0], [12.0, 13.0], [2.0, 13.0]], &[0, 1, 2, 0, 2, 3], half);
        let picture = raster().draw(&[square], [16, 16], 1.0, Color32::BLACK);
        for (k, pixel) in picture.pixels.iter().enumerate() {
            let (x, y) = (k % 16, k / 16);
            let inside = (2..12).contains(&x) && (3..9).contains(&y);
            assert_eq!(pixel.r(), if inside { 100 } else { 0 }, "{x} {y}");
        }
    }

    /// Winding does not matter, and neither do degenerate or infinite triangles.
    #[test]
    fn odd_triangles_do_no_harm() {
        let draw = |corners: &[[f32; 2]], indices: &[u32]| {
            raster().draw(&[mesh(corners, indices, Color32::WHITE)], [8, 8], 1.0, Color32::BLACK)
        };
        let corners = [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]];
        assert_eq!(draw(&corners, &[0, 1, 2]), draw(&corners, &[0, 2, 1]));
        let black = ColorImage::filled([8, 8], Color32::BLACK);
        assert_eq!(draw(&[[1.0, 1.0], [5.0, 5.0], [7.0, 7.0]], &[0, 1, 2]), black);
        assert_eq!(draw(&[[f32::NAN, 1.0], [5.0, f32::INFINITY], [7.0, 7.0]], &[0, 1, 2]), black);
    }
}
