// A pixel's rim: depth of the disc whose outer part is all that reaches it, 0 for none.
const float kGap = 1e-6;          // m, instead of a depth: nothing reaches it, inside of a surface
const float kGapGrowth = 1.75;    // of discs that close gaps
