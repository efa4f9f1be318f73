// How the air's shadow is laid out: AIR_SLICES pictures side by side, 4 in a row, of every AIR_SPACING-th pixel each way.
const float AIR_SPACING = 8.0;
const int AIR_SLICES = 32, AIR_ACROSS = 4;

// The texel where picture `slice` begins.
ivec2 air_corner(int slice, ivec2 size) { return ivec2(slice % AIR_ACROSS, slice / AIR_ACROSS) * size; }
