/* A point light's checks. */
#include <math.h>

#include "shape/pathtrace.h"

bool shape_lamp_shines(const shape_lamp *lamp)
{
    return lamp->intensity[0] > 0 || lamp->intensity[1] > 0 || lamp->intensity[2] > 0;
}

shape_status shape_lamp_check(const shape_lamp *lamp, shape_error *error)
{
    for (int c = 0; c < 3; c++)
        if (!(lamp->intensity[c] >= 0) || !isfinite(lamp->intensity[c]))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "lamp intensity: must be finite and not negative");
    if (!isfinite(lamp->position.x) || !isfinite(lamp->position.y) || !isfinite(lamp->position.z))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "lamp position: must be finite");
    return SHAPE_OK;
}
