/* What differs between a cloud and the same cloud after an edit: where its density may be another one, so that grids of it
 * (shape/bake.h, shape/lightgrid.h, shape/sunsweep.h) are made again there and nowhere else. */
#ifndef SHAPE_CHANGE_H
#define SHAPE_CHANGE_H

#include "shape/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SHAPE_CHANGE_BOXES = 4096 }; /* at most; where more primitives differ, all has changed */

/* Zeroed: nothing has changed. */
typedef struct shape_change {
    bool all;         /* the whole density may be another one: `boxes` tells nothing */
    shape_box *boxes; /* outside these the density is the same to the bit [cloud's frame] */
    size_t count;
} shape_change;

/* Compares a cloud before an edit and after it. Primitives are told apart by their bytes, wherever they stand in their lists:
 * the boxes are those of the supports of all that were there only before, and all that are there only after (one that moved,
 * grew or shrank counts as both), widened by displacement and smooth union. All has changed where the field, the box (see
 * shape_volume_keep_boxes) or anything else differs that every point's density depends on: the heights that details go by, the
 * voxels of a grid, and, of metaballs and layers, any primitive. The placement and the medium do not count: they change no
 * density. Both volumes must be there. The caller frees *change by shape_change_free, also after an error (memory). */
shape_status shape_change_find(const shape_volume_cloud *before, const shape_volume_cloud *after,
                               shape_change *change, shape_error *error);
void shape_change_free(shape_change *change);

/* Whether anything has changed at all. */
bool shape_change_is_any(const shape_change *change);
/* Whether a box touches one of the change's. Always where all has changed. */
bool shape_change_touches(const shape_change *change, shape_box box);

/* Gives the clouds of a volume the boxes of those with the same numbers in an earlier one, where these hold theirs and are
 * not much larger (by half their volume at the most): a box may be too large, and grids over it stay where they are while an
 * edit stays within it. For the eye of someone who edits: pictures then depend a little on what was there before. */
void shape_volume_keep_boxes(shape_volume *volume, const shape_volume *before);

#ifdef __cplusplus
}
#endif
#endif
