/* Private: a clear sky as it is seen through a cloud that scatters ahead. */
#ifndef SHAPE_LIGHT_SKYSPREAD_H
#define SHAPE_LIGHT_SKYSPREAD_H

#include "shape/view.h"
#include "shape/volume.h"

typedef float skyspread_lanes __attribute__((vector_size(16), aligned(16)));

/* Radiance in all directions after 1, 2, 4, 8 and 16 scatterings within the peak: rows of equal solid angle from below, columns
 * round. Of each the first three numbers are red, green and blue. */
enum { SKYSPREAD_LEVELS = 5, SKYSPREAD_ROWS = 12, SKYSPREAD_COLUMNS = 24 };
typedef skyspread_lanes skyspread_level[SKYSPREAD_ROWS][SKYSPREAD_COLUMNS];
typedef struct skyspread {
    skyspread_level levels[SKYSPREAD_LEVELS];
} skyspread;

/* medium: with a peak (shape_delta_scaling's share above 0). The caller frees *out. Errors: memory. */
shape_status skyspread_make(const shape_sky *sky, const shape_medium *medium, int threads, skyspread **out,
                            shape_error *error);

/* Radiance from a direction (unit, world, where one looks) after so many scatterings within the peak, 1 and more. */
skyspread_lanes skyspread_look(const skyspread *spread, shape_vec3 direction, float turns);

#endif
