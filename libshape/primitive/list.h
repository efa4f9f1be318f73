/* Private: what a list asks of each member, for sets that were filled otherwise. */
#ifndef SHAPE_PRIMITIVE_LIST_H
#define SHAPE_PRIMITIVE_LIST_H

#include "shape/set.h"

/* SHAPE_ERROR_ARGUMENT where a number is not finite, or a radius not above 0. */
shape_status list_check_sphere(const shape_sphere *sphere, shape_error *error);
shape_status list_check_ellipsoid(const shape_ellipsoid *ellipsoid, shape_error *error);

#endif
