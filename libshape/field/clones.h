/* Private: functions that exist for several processors, of which the right one is chosen when the program is loaded. The
 * results do not depend on which: products and sums stay two roundings (-ffp-contract=off). */
#ifndef SHAPE_FIELD_CLONES_H
#define SHAPE_FIELD_CLONES_H

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define NEPHELE_CLONES
#endif
#endif
/* The choice is made before a sanitizer is ready for it; clang 14 has no such attribute for static functions. */
#if !defined(NEPHELE_CLONES)
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && defined(__GNUC__) &&                  \
    !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define NEPHELE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define NEPHELE_CLONES
#endif
#endif

#endif
