/* Private: which cloud names of a set are taken, told in constant time. */
#ifndef SHAPE_PRIMITIVE_NAMES_H
#define SHAPE_PRIMITIVE_NAMES_H

#include "shape/set.h"

/* Takes in the clouds that came since the last call; shape_names_taken is then true to them. Error: memory. */
shape_status shape_names_update(shape_set *set, shape_error *error);
/* Whether a cloud of the set has that name. */
bool shape_names_taken(const shape_set *set, const char *name);

#endif
