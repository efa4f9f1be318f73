/* The random streams of shape/random.h as functions that the compiler puts where they are called: derivation and turtle
 * draw several times for each of millions of symbols. random.c's own functions are these. */
#ifndef BASE_RANDOM_INLINE_H
#define BASE_RANDOM_INLINE_H

#include "shape/random.h"

static inline uint64_t random_hash(uint64_t value)
{
    value += 0x9e3779b97f4a7c15u;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return value ^ (value >> 31);
}

static inline uint32_t random_u32(shape_random *random)
{
    uint64_t old = random->state;
    random->state = old * 6364136223846793005u + random->increment;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27);
    unsigned rotation = (unsigned)(old >> 59);
    return (shifted >> rotation) | (shifted << ((32 - rotation) & 31));
}

static inline shape_random random_seed(uint64_t seed, uint64_t stream)
{
    shape_random random = {0, (random_hash(stream) << 1) | 1};
    random_u32(&random);
    random.state += random_hash(seed);
    random_u32(&random);
    return random;
}

static inline double random_unit(shape_random *random)
{
    uint64_t high = random_u32(random), low = random_u32(random);
    return (double)(((high << 32) | low) >> 11) * 0x1p-53;
}

static inline double random_range(shape_random *random, double low, double high)
{
    return low + (high - low) * random_unit(random);
}

#endif
