#pragma once

// Compiled for AVX2 as well, and chosen when the program starts. No product is fused with a sum on
// either (-ffp-contract=off): results are the same on every processor.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define GLOWWORM_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define GLOWWORM_WIDE
#endif
