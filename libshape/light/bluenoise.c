/* Blue noise by void and cluster: Ulichney 1993, "The void-and-cluster method for dither array generation", with his
 * Gaussian of standard deviation 1.5 on a torus. */
#include "light/bluenoise.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "shape/random.h"

enum { N = BLUENOISE_SIZE, COUNT = BLUENOISE_COUNT, REACH = 6, FIRST = COUNT / 10 };

typedef struct tile {
    float weight[2 * REACH + 1][2 * REACH + 1];
    float energy[COUNT]; /* how crowded a place is by the points that are set */
    bool set[COUNT];
} tile;

static void change(tile *t, int place, bool set)
{
    int x = place % N, y = place / N;
    float sign = set ? 1 : -1;
    t->set[place] = set;
    for (int j = -REACH; j <= REACH; j++)
        for (int i = -REACH; i <= REACH; i++)
            t->energy[(y + j + N) % N * N + (x + i + N) % N] += sign * t->weight[j + REACH][i + REACH];
}

/* The most crowded place that is set, or the emptiest that is not. */
static int extreme(const tile *t, bool set)
{
    int best = -1;
    for (int i = 0; i < COUNT; i++)
        if (t->set[i] == set &&
            (best < 0 || (set ? t->energy[i] > t->energy[best] : t->energy[i] < t->energy[best])))
            best = i;
    return best;
}

/* A tenth of all places by chance, then the tightest cluster's middle moved into the largest void until it stays. */
static void spread_first(tile *t, uint64_t seed)
{
    shape_random random = shape_random_seed(seed, 0);
    for (int count = 0; count < FIRST;) {
        int place = (int)(shape_random_unit(&random) * COUNT);
        if (!t->set[place]) {
            change(t, place, true);
            count++;
        }
    }
    for (int turn = 0; turn < COUNT; turn++) {
        int cluster = extreme(t, true);
        change(t, cluster, false);
        int gap = extreme(t, false);
        change(t, gap, true);
        if (gap == cluster)
            break;
    }
}

shape_status bluenoise_make(uint64_t seed, uint16_t rank[BLUENOISE_COUNT], shape_error *error)
{
    tile *t = calloc(2, sizeof *t);
    if (!t)
        return shape_error_memory(error);
    for (int j = -REACH; j <= REACH; j++)
        for (int i = -REACH; i <= REACH; i++)
            t->weight[j + REACH][i + REACH] = (float)exp(-(i * i + j * j) / (2 * 1.5 * 1.5));
    spread_first(t, seed);
    t[1] = t[0];
    /* The first points get their ranks as they are taken away again, the tightest last; all others as they fill the
     * voids. Ulichney's third phase, clusters of the empty places, finds the same places as these voids do. */
    for (int r = FIRST - 1; r >= 0; r--) {
        int cluster = extreme(&t[1], true);
        change(&t[1], cluster, false);
        rank[cluster] = (uint16_t)r;
    }
    for (int r = FIRST; r < COUNT; r++) {
        int gap = extreme(&t[0], false);
        change(&t[0], gap, true);
        rank[gap] = (uint16_t)r;
    }
    free(t);
    return SHAPE_OK;
}
