/* Times of the generators and of pruning, as tables: a cumulus of 35 spheres, a grammar's million, and pruning from a
 * hundred to a million spheres, by the tree and (to ten thousand) by the double loop, beside the time to write them.
 * Wall-clock times, the least of several runs. At the end, what pruning changes in the density of twenty clouds.
 * Arguments: none. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "shape/file.h"
#include "shape/gaussian.h"
#include "shape/neph.h"
#include "shape/prune.h"
#include "shape/random.h"
#include "shape/turtle.h"
#include "shape/volume.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void stop(const shape_error *error)
{
    fprintf(stderr, "bench_primitives: %s\n", error->text);
    exit(1);
}

/* One cloud of so many spheres in a cube in which ten cover each point, radii 0.5 to 1.5: some lie in others. */
static shape_set *random_set(size_t count)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    if (!set || shape_set_add_cloud(set, "c", NULL, &error) ||
        shape_primitives_reserve(shape_set_list(set, 0), count, 0, &error))
        stop(&error);
    shape_primitives *list = shape_set_list(set, 0);
    shape_random r = shape_random_seed(1, 0);
    double side = cbrt((double)count * 5.24 / 10); /* the mean volume of a sphere is 5.24 */
    for (size_t i = 0; i < count; i++) {
        shape_sphere s = {(float)shape_random_range(&r, 0, side), (float)shape_random_range(&r, 0, side),
                          (float)shape_random_range(&r, 0, side), (float)shape_random_range(&r, 0.5, 1.5)};
        list->spheres[list->sphere_count++] = s;
    }
    return set;
}

/* The same in the shape of a cumulus, all within a few metres, and not one inside another. */
static shape_set *dense_set(size_t count)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_gaussian o = shape_gaussian_defaults();
    o.count = count;
    o.prune = o.hollow = false;
    o.clamp_mode = SHAPE_CLAMP_REJECT;
    if (!set || shape_set_add_cloud(set, "c", NULL, &error) ||
        shape_gaussian_make(&o, 1, shape_set_list(set, 0), NULL, &error))
        stop(&error);
    return set;
}

static size_t double_loop(shape_primitives *list)
{
    size_t kept = 0, count = list->sphere_count;
    unsigned char *gone = calloc(count, 1);
    for (size_t i = 0; i < count && gone; i++)
        for (size_t j = 0; j < count && !gone[i]; j++)
            gone[i] = i != j && (list->spheres[j].radius > list->spheres[i].radius || j < i) &&
                      shape_sphere_contains(list->spheres[j], list->spheres[i]);
    for (size_t i = 0; i < count && gone; i++)
        if (!gone[i])
            list->spheres[kept++] = list->spheres[i];
    list->sphere_count = kept;
    free(gone);
    return count - kept;
}

/* Milliseconds to prune a fresh copy of the set's list; *removed gets how many went. */
static double time_prune(const shape_set *set, bool by_tree, int runs, size_t *removed)
{
    shape_error error;
    double best = INFINITY;
    const shape_primitives *from = shape_set_list_const(set, 0);
    for (int run = 0; run < runs; run++) {
        shape_primitives list = {0};
        if (shape_primitives_reserve(&list, from->sphere_count, 0, &error))
            stop(&error);
        memcpy(list.spheres, from->spheres, from->sphere_count * sizeof *from->spheres);
        list.sphere_count = from->sphere_count;
        double start = now();
        if (by_tree && shape_primitives_prune(&list, removed, &error))
            stop(&error);
        if (!by_tree)
            *removed = double_loop(&list);
        best = fmin(best, now() - start);
        free(list.spheres);
        free(list.ellipsoids);
    }
    return 1e3 * best;
}

/* Milliseconds to encode the set and to write it beside the working folder's files, flushed to the disk. */
static double time_write(const shape_set *set, int runs)
{
    static const char *const path = "bench_primitives.neph";
    shape_error error;
    double best = INFINITY;
    for (int run = 0; run < runs; run++) {
        unsigned char *bytes;
        size_t size;
        double start = now();
        if (shape_neph_encode(set, &bytes, &size, &error) || shape_file_write(path, bytes, size, &error))
            stop(&error);
        best = fmin(best, now() - start);
        free(bytes);
    }
    remove(path);
    return 1e3 * best;
}

static void bench_prune(const char *what, shape_set *(*make)(size_t))
{
    printf("\n| %s | removed | tree, ms | ns a sphere | double loop, ms | writing, ms "
           "|\n|---|---|---|---|---|---|\n",
           what);
    for (size_t count = 100; count <= 1000000; count *= 10) {
        shape_set *set = make(count);
        int runs = count < 100000 ? 20 : 5;
        size_t removed, removed_twin;
        double tree = time_prune(set, true, runs, &removed), twin = -1;
        if (count <= 10000) {
            twin = time_prune(set, false, count < 10000 ? 5 : 2, &removed_twin);
            if (removed != removed_twin) {
                fprintf(stderr, "bench_primitives: the tree and the double loop disagree\n");
                exit(1);
            }
        }
        printf("| %zu | %zu | %.3f | %.0f |", count, removed, tree, 1e6 * tree / (double)count);
        printf(twin < 0 ? " |" : " %.3f |", twin);
        printf(" %.2f |\n", time_write(set, 3));
        fflush(stdout);
        shape_set_destroy(set);
    }
}

/* Microseconds for one default cumulus, the memory of its list included; the mean of a batch, least of ten batches. */
static double time_cumulus(void)
{
    enum { BATCH = 1000 };
    shape_error error;
    shape_gaussian options = shape_gaussian_defaults();
    double best = INFINITY;
    for (uint64_t batch = 0; batch < 10; batch++) {
        double start = now();
        for (uint64_t seed = 0; seed < BATCH; seed++) {
            shape_primitives list = {0};
            if (shape_gaussian_make(&options, batch * BATCH + seed, &list, NULL, &error))
                stop(&error);
            free(list.spheres);
            free(list.ellipsoids);
        }
        best = fmin(best, now() - start);
    }
    return 1e6 * best / BATCH;
}

/* Milliseconds for the paper's grammar (Eq. 18) at 20 iterations: 1,048,576 spheres. */
static double time_grammar(size_t *count)
{
    static const char text[] =
        "axiom X\niterations 20\nangle 50..100\nshrink 0.9..1.0\nX -> X + Y\nY -> X & Y\n";
    shape_error error;
    double best = INFINITY;
    static shape_mistakes mistakes;
    for (int run = 0; run < 5; run++) {
        shape_primitives list = {0};
        shape_grammar *grammar;
        double start = now();
        if (shape_grammar_parse(text, sizeof text - 1, "bench", &grammar, &mistakes, &error))
            stop(&error);
        shape_derive_options options = shape_derive_defaults(grammar);
        options.max_primitives = 2000000;
        if (shape_grammar_grow(grammar, &options, &list, NULL, &error))
            stop(&error);
        best = fmin(best, now() - start);
        *count = shape_primitives_count(&list);
        shape_grammar_destroy(grammar);
        free(list.spheres);
        free(list.ellipsoids);
    }
    return 1e3 * best;
}

/* A cumulus of the inverse radius law with the paper's largest radius: some of its spheres lie in others. */
static shape_set *inverse_set(bool prune, shape_model model, uint64_t seed)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    shape_gaussian o = shape_gaussian_defaults();
    o.radius_law = SHAPE_RADIUS_INVERSE;
    o.max_radius = 15;
    o.hollow = false;
    o.prune = prune;
    if (!set || shape_set_add_cloud(set, "c", NULL, &error) ||
        shape_gaussian_make(&o, seed, shape_set_list(set, 0), NULL, &error))
        stop(&error);
    set->clouds[0].field.model = model;
    set->clouds[0].field.noise_scale = 0.3f;
    return set;
}

/* How the density at random points differs with and without pruning, over the points where either has some. */
static void measure_model(const char *name, shape_model model)
{
    enum { POINTS = 20000, SEEDS = 20 };
    size_t inside = 0, changed = 0, spheres[2] = {0, 0};
    double sum[2] = {0, 0};
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        shape_error error;
        shape_set *sets[2];
        shape_volume *volumes[2];
        for (int k = 0; k < 2; k++) {
            sets[k] = inverse_set(k == 1, model, seed);
            spheres[k] += shape_set_list(sets[k], 0)->sphere_count;
            if (shape_volume_create(sets[k], &volumes[k], &error))
                stop(&error);
        }
        shape_box box = shape_cloud_box(&sets[0]->clouds[0], shape_set_list(sets[0], 0));
        shape_random r = shape_random_seed(seed, 9);
        for (int i = 0; i < POINTS; i++) {
            shape_dvec3 p = {shape_random_range(&r, box.min.x, box.max.x),
                             shape_random_range(&r, box.min.y, box.max.y),
                             shape_random_range(&r, box.min.z, box.max.z)};
            double a = shape_volume_extinction(volumes[0], p), b = shape_volume_extinction(volumes[1], p);
            inside += a > 0 || b > 0;
            changed += a != b;
            sum[0] += a;
            sum[1] += b;
        }
        for (int k = 0; k < 2; k++) {
            shape_volume_destroy(volumes[k]);
            shape_set_destroy(sets[k]);
        }
    }
    printf("| %s | %zu | %zu | %.2f %% | %+.2f %% |\n", name, spheres[0], spheres[1],
           100 * (double)changed / (double)inside, 100 * (sum[1] / sum[0] - 1));
}

static void measure_pruning(void)
{
    printf("\n| model | spheres | after pruning | points changed | all density |\n|---|---|---|---|---|\n");
    measure_model("uniform", SHAPE_MODEL_UNIFORM);
    measure_model("spheroid", SHAPE_MODEL_SPHEROID);
    measure_model("metaball", SHAPE_MODEL_METABALL);
}

int main(void)
{
    size_t count;
    double cumulus = time_cumulus(), grammar = time_grammar(&count);
    printf("| generator | time | bound |\n|---|---|---|\n");
    printf("| cumulus of 35 spheres, hollowed and pruned | %.1f us | 14 us |\n", cumulus);
    printf("| grammar, %zu spheres | %.0f ms | 80 ms |\n", count, grammar);
    bench_prune("spheres, ten at each point", random_set);
    bench_prune("spheres of one cumulus", dense_set);
    measure_pruning();
    return 0;
}
