/* Holds every row of the table of docs/stability.md; with --markdown, prints it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "row.h"

static const stability_part *const parts[] = {&stability_steps, &stability_rays, &stability_forms,
                                              &stability_places, &stability_amounts};
enum { PARTS = sizeof parts / sizeof *parts, ROWS_MOST = 256 };
static const double energy_depth = 10;

static bool in_bounds(const stability_row *row, double value)
{
    return value >= row->low && value <= row->high; /* not a NaN */
}

static void plain_fails_and_ours_holds(void **state)
{
    const stability_row *row = *state;
    double plain, ours;
    row->measure(row->x, &plain, &ours);
    if (in_bounds(row, plain))
        fail_msg("%s: the plain way holds (%g, bounds %.9g to %.9g); the row is not true", row->where, plain,
                 row->low, row->high);
    if (!in_bounds(row, ours))
        fail_msg("%s: %.9g, bounds %.9g to %.9g", row->where, ours, row->low, row->high);
}

static void energy_is_as_claimed(void **state)
{
    const stability_energy *energy = *state;
    double flux, furnace;
    stability_energy_measure(energy, energy_depth, &flux, &furnace);
    assert_true(isfinite(flux) && flux >= 0);
    if (energy->flux > 0 && !stability_energy_holds(energy, flux, furnace))
        fail_msg("%s: flux %.4f, furnace %.4f", energy->light, flux, furnace);
    /* A light that claims nothing has a reason: it gains or loses 5 % and more. */
    if (!(energy->flux > 0) && fabs(flux - 1) <= 0.05)
        fail_msg("%s conserves energy here and could claim it: flux %.4f", energy->light, flux);
}

/* --- the page --- */

static void print_number(double value)
{
    if (isnan(value))
        printf("NaN");
    else if (isinf(value))
        printf(value > 0 ? "infinity" : "-infinity");
    else if (fabs(value - 1) < 9e-4 && value != 1)
        printf(fabs(value - 1) < 5e-8 ? "1" : "1 %c %.2g", value > 1 ? '+' : '-', fabs(value - 1));
    else
        printf("%.3g", value);
}

static void print_bound(const stability_row *row)
{
    if (row->low == row->high) {
        print_number(row->low);
        return;
    }
    print_number(row->low);
    printf(" to ");
    print_number(row->high);
}

static void print_part(const stability_part *part)
{
    printf("\n## %s\n\n| where | the plain way | here | measured | plain | here | bounds "
           "|\n|---|---|---|---|---|---|---|\n",
           part->title);
    for (size_t i = 0; i < part->count; i++) {
        const stability_row *row = &part->rows[i];
        double plain, ours;
        row->measure(row->x, &plain, &ours);
        printf("| %s | %s | %s | %s | ", row->where, row->plain, row->ours, row->quantity);
        print_number(plain);
        printf(" | ");
        print_number(ours);
        printf(" | ");
        print_bound(row);
        printf(" |\n");
    }
}

static void print_energy(void)
{
    printf("\n## Energy\n\nA white ball with isotropic scattering, optical diameter %g. Flux: what leaves it "
           "of what it "
           "scatters of the sun's\nlight, 1 in truth. Furnace: the mean radiance of rays through it under a "
           "sky of 1, 1 in "
           "truth. Powder, emission, the 2018\nsum and the other lights of one scattering do not claim to "
           "conserve "
           "energy, and do not.\n\n| light | claims | flux | furnace |\n|---|---|---|---|\n",
           energy_depth);
    for (int i = 0; i < STABILITY_ENERGIES; i++) {
        const stability_energy *energy = &stability_energies[i];
        double flux, furnace;
        stability_energy_measure(energy, energy_depth, &flux, &furnace);
        if (energy->flux > 0)
            printf("| %s | flux within %g %%, furnace within %g %% | %.3f | ", energy->light,
                   100 * energy->flux, 100 * energy->furnace, flux);
        else
            printf("| %s | nothing | %.3f | ", energy->light, flux);
        if (isnan(furnace))
            printf("no sky |\n");
        else
            printf("%.3f |\n", furnace);
    }
}

static void print_head(void)
{
    printf("# Where methods fail\n\n"
           "Each row is a case in which a plain way of computing something fails, what is done here instead, "
           "and one "
           "quantity measured\nby both. The bounds are the truth and what rounding adds to it. "
           "`test_stability`, which runs with all tests, fails where the\nplain way is inside the bounds "
           "(the row would "
           "not be true) or ours outside; the page is printed from the same rows:\n\n"
           "    cmake --preset release && cmake --build build/release\n"
           "    build/release/tests/stability/test_stability --markdown > docs/stability.md\n"
           "    build/release/tests/stability/sweep 100000 >> docs/stability.md\n");
}

static void print_sweep_head(void)
{
    printf("\n## Random scenes\n\n"
           "`sweep COUNT [FIRST]` renders pictures of up to 8x6, forty a scene, with everything drawn by "
           "chance, ends of ranges as often\n"
           "as what lies between: the five field models and their details, up to three clouds and a copy, "
           "none to 150 primitives, sizes a\n"
           "million times apart, needles and coins, units from 0.1 mm to 1,000 km, frames that scale, mirror "
           "and stand far away, curved\n"
           "layers, optical depth 0.001 to 10,000, every phase function with g to 0.9999, kappa 0 and 1, "
           "suns on, under and over the\n"
           "horizon, eyes inside and outside, meshes, and every option of the march, the reference, with and "
           "without its grain, and the\n"
           "methods of 2018 (these in scenes below 100 m: their steps are 0.1 m). Checks of energy: paths "
           "and walks of the reference\n"
           "through white clouds in a white furnace bring exactly 1; the march sees a sky of 1 through black "
           "clouds as 0 to 1 with every\n"
           "rule, and a source of 1 as at most 1 with the default rule; the light `grid` brings 1 within 10 "
           "%% in a white furnace where it\n"
           "claims to: one cloud without meshes, mean cosine -0.5 to 0.86, extinction times the longest side "
           "up to 300. Its flux is\n"
           "told, not checked. Metaballs and details are given few primitives, for the time's sake; the "
           "viewer's pictures are not in the\n"
           "sweep. Paths are not traced where the optical depth along a cloud's longest side would be above "
           "10,000 at its "
           "densest,\nand have 30 collisions at most where it would be above 1,000. CTest runs 200 pictures. "
           "Last run:\n\n");
}

static int print_page(void)
{
    print_head();
    for (int i = 0; i < PARTS; i++)
        print_part(parts[i]);
    print_energy();
    print_sweep_head();
    return 0;
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--markdown"))
        return print_page();
    static struct CMUnitTest tests[ROWS_MOST];
    size_t count = 0;
    for (int k = 0; k < PARTS; k++)
        for (size_t i = 0; i < parts[k]->count; i++) {
            const stability_row *row = &parts[k]->rows[i];
            tests[count++] =
                (struct CMUnitTest){row->where, plain_fails_and_ours_holds, NULL, NULL, (void *)row};
        }
    for (int i = 0; i < STABILITY_ENERGIES; i++)
        tests[count++] = (struct CMUnitTest){stability_energies[i].light, energy_is_as_claimed, NULL, NULL,
                                             (void *)&stability_energies[i]};
    return _cmocka_run_group_tests("stability", tests, count, NULL, NULL);
}
