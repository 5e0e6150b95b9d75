//! Colours that people with colour-blindness tell apart (okabe2008), in a shade for light and one for dark paper.

/// Blue, vermilion, green, purple, orange, sky blue, grey, brown-yellow; on light paper.
pub const PALETTE: [&str; 8] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#707070", "#B8A800"];

/// The same as numbers, `[on light, on dark][colour][red, green, blue]`.
pub const SHADES: [[[u8; 3]; 8]; 2] = [
    [
        [0x00, 0x72, 0xb2],
        [0xd5, 0x5e, 0x00],
        [0x00, 0x9e, 0x73],
        [0xcc, 0x79, 0xa7],
        [0xe6, 0x9f, 0x00],
        [0x56, 0xb4, 0xe9],
        [0x70, 0x70, 0x70],
        [0xb8, 0xa8, 0x00],
    ],
    [
        [0x3f, 0x9f, 0xe0],
        [0xf0, 0x7a, 0x2b],
        [0x1f, 0xc2, 0x96],
        [0xdd, 0x92, 0xbb],
        [0xf0, 0xb4, 0x29],
        [0x9b, 0xd4, 0xf7],
        [0x9a, 0xa0, 0xa8],
        [0xd6, 0xc6, 0x3a],
    ],
];

/// Number of a colour in the palette; larger numbers begin anew.
pub type Ink = usize;
