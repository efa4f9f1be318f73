/* A clear sky through the peak of forward scattering. The delta scaling takes what is scattered within it as going
 * straight on, and the bright band of the horizon would be seen through a cloud as sharp as beside it, up to a fifth
 * too bright. Light that was scattered n times has been turned n times: the sky is convolved n times with the peak
 * (Goudsmit and Saunderson 1940, for electrons). Once is done with the peak itself, more with the distribution of von
 * Mises and Fisher that has the n-th power of its mean cosine. */
#include "light/skyspread.h"

#include <math.h>
#include <stdlib.h>

#include "shape/beam.h"
#include "shape/phase.h"

enum { ROWS = SKYSPREAD_ROWS, COLUMNS = SKYSPREAD_COLUMNS };

typedef shape_vec3 all_directions[ROWS][COLUMNS];

static void find_directions(all_directions out)
{
    for (int row = 0; row < ROWS; row++)
        for (int column = 0; column < COLUMNS; column++) {
            const float up = -1 + 2 * ((float)row + 0.5f) / ROWS, level = sqrtf(1 - up * up);
            const float turn = ((float)column + 0.5f) * (6.2831853f / COLUMNS);
            out[row][column] = shape_vec3_make(level * sinf(turn), up, level * cosf(turn));
        }
}

/* How much of row b goes into row a, from so many columns on. */
typedef float all_shares[ROWS][ROWS][COLUMNS];

static void find_shares(const shape_medium *medium, const shape_beam_peak *peak, int turns,
                        const all_directions directions, all_shares out)
{
    const float narrow = 1 / fmaxf(1 - powf(peak->ahead, (float)turns), 1e-4f);
    for (int a = 0; a < ROWS; a++)
        for (int b = 0; b < ROWS; b++)
            for (int c = 0; c < COLUMNS; c++) {
                float cosine = fminf(shape_vec3_dot(directions[a][0], directions[b][c]), 1);
                out[a][b][c] = turns > 1 ? expf(narrow * (cosine - 1))
                                         : fmaxf(shape_phase(medium, cosine) - peak->cap, 0);
            }
}

/* bare: with 1 in the fourth lane, which becomes the sum of the shares. */
static void convolve(const skyspread_level bare, const all_shares shares, skyspread_level out)
{
    for (int row = 0; row < ROWS; row++)
        for (int column = 0; column < COLUMNS; column++) {
            skyspread_lanes sum = {0, 0, 0, 0};
            for (int from = 0; from < ROWS; from++)
                for (int c = 0; c < COLUMNS; c++)
                    sum += shares[row][from][c] * bare[from][(column + c) % COLUMNS];
            out[row][column] = sum / sum[3];
        }
}

shape_status skyspread_make(const shape_sky *sky, const shape_medium *medium, int threads, skyspread **out,
                            shape_error *error)
{
    skyspread_level bare;
    all_directions directions;
    const shape_beam_peak peak = shape_beam_peak_make(medium);
    skyspread *made = malloc(sizeof *made);
    if (!made)
        return shape_error_memory(error);
    find_directions(directions);
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < COLUMNS; j++) {
            float rgb[3];
            shape_sky_radiance(sky, directions[i][j], rgb);
            bare[i][j] = (skyspread_lanes){rgb[0], rgb[1], rgb[2], 1};
        }
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int level = 0; level < SKYSPREAD_LEVELS; level++) {
        all_shares shares;
        find_shares(medium, &peak, 1 << level, directions, shares);
        convolve(bare, shares, made->levels[level]);
    }
    *out = made;
    return SHAPE_OK;
}

static skyspread_lanes look_at(const skyspread_level level, float row, float column)
{
    const int i = (int)row, j = (int)column;
    const int above = i + 1 < ROWS ? i + 1 : i, beside = j + 1 < COLUMNS ? j + 1 : 0;
    const float up = row - (float)i, round = column - (float)j;
    return (1 - up) * ((1 - round) * level[i][j] + round * level[i][beside]) +
           up * ((1 - round) * level[above][j] + round * level[above][beside]);
}

skyspread_lanes skyspread_look(const skyspread *spread, shape_vec3 d, float turns)
{
    const float row = fminf(fmaxf((d.y + 1) * (0.5f * ROWS) - 0.5f, 0), ROWS - 1);
    float column = atan2f(d.x, d.z) * (COLUMNS / 6.2831853f) - 0.5f;
    column = column < 0 ? column + COLUMNS : column;
    column = column >= 0 && column < COLUMNS ? column : 0;
    const float level = fminf(log2f(fmaxf(turns, 1)), SKYSPREAD_LEVELS - 1);
    const int below = (int)level, above = below + 1 < SKYSPREAD_LEVELS ? below + 1 : below;
    const float part = level - (float)below;
    return (1 - part) * look_at(spread->levels[below], row, column) +
           part * look_at(spread->levels[above], row, column);
}
