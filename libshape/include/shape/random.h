/* Seeded random streams and elementary functions whose results are the same with every compiler, processor and C
 * library: integer arithmetic and plain IEEE operations only. Generators use these and never libm's exp, log, sin. */
#ifndef SHAPE_RANDOM_H
#define SHAPE_RANDOM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A stream of random numbers (PCG-XSH-RR 64/32, O'Neill 2014). A plain value: copy it to branch. Not thread-safe;
 * give each thread its own stream. */
typedef struct shape_random {
    uint64_t state, increment;
} shape_random;

/* The stream that belongs to (seed, stream); different pairs give independent sequences. */
shape_random shape_random_seed(uint64_t seed, uint64_t stream);
/* The next 32 bits. */
uint32_t shape_random_u32(shape_random *random);
/* Uniform in [0, 1), 53 bits (two draws). */
double shape_random_unit(shape_random *random);
/* Uniform in [low, high); low where low == high (a draw is used all the same). */
double shape_random_range(shape_random *random, double low, double high);
/* Normal with mean 0 and standard deviation 1 (Marsaglia and Bray 1964, polar; one value a call). */
double shape_random_normal(shape_random *random);

/* A 64-bit mix of its argument (splitmix64's finaliser, Steele et al. 2014): hashes of indices and seeds. */
uint64_t shape_hash(uint64_t value);

/* Elementary functions, within 2 units in the last place over the usual range (|x| <= 1e5 for sin and cos).
 * shape_log of 0 is -infinity, of a negative number NaN; shape_exp under- and overflows like libm's. */
double shape_exp(double x);
double shape_log(double x);
double shape_sin(double x); /* radians */
double shape_cos(double x);
void shape_sin_cos(double x, double *sine, double *cosine); /* both, in the time of one */
/* x to the power y: repeated products where y is a whole number up to 64 in size (within 2 |y| + 1 units in the last
 * place), else exp(y log x) (within 2 + 2 |y log x|). */
double shape_pow(double x, double y);

#ifdef __cplusplus
}
#endif
#endif
