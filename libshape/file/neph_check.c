/* What the writer and the reader of .neph files check alike: chunk types, texts, bounding boxes. */
#include "file/neph_layout.h"

#include <math.h>
#include <stdlib.h>

bool neph_type_is_valid(const char type[4])
{
    for (int i = 0; i < 4; i++) {
        char c = type[i];
        if (!((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')))
            return false;
    }
    return true;
}

bool neph_type_is_known(const char type[4])
{
    return !memcmp(type, "CLUD", 4) || !memcmp(type, "TEXT", 4) || !memcmp(type, "SPHR", 4) ||
           !memcmp(type, "ELLI", 4);
}

/* How many bytes the UTF-8 character at `text` takes, and its code; 0 where it is none (RFC 3629: no overlong form, no
 * surrogate, nothing above U+10FFFF). */
static size_t decode_utf8(const unsigned char *text, size_t room, uint32_t *code)
{
    static const uint32_t smallest[5] = {0, 0, 0x80, 0x800, 0x10000};
    unsigned char first = text[0];
    size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    if (!length || length > room)
        return 0;
    uint32_t value = length == 1 ? first : first & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if (text[i] >> 6 != 2)
            return 0;
        value = value << 6 | (text[i] & 0x3fu);
    }
    if (value < smallest[length] || value > 0x10ffff || (value >= 0xd800 && value <= 0xdfff))
        return 0;
    *code = value;
    return length;
}

bool neph_text_is_plain(const char *text, size_t length)
{
    const unsigned char *at = (const unsigned char *)text;
    while (length) {
        uint32_t code = 0;
        size_t step = decode_utf8(at, length, &code);
        if (!step || code < 0x20 || (code >= 0x7f && code < 0xa0))
            return false;
        at += step;
        length -= step;
    }
    return true;
}

static bool is_finite_box(const shape_frame *frame, shape_box box)
{
    if (shape_box_is_empty(box))
        return true;
    shape_dvec3 min, max;
    shape_frame_box(frame, box, &min, &max);
    /* A sum is finite only if every term is. */
    double local = (double)box.min.x + (double)box.min.y + (double)box.min.z + (double)box.max.x +
                   (double)box.max.y + (double)box.max.z;
    return isfinite(local) && isfinite(min.x) && isfinite(min.y) && isfinite(min.z) && isfinite(max.x) &&
           isfinite(max.y) && isfinite(max.z) && min.x <= max.x && min.y <= max.y && min.z <= max.z;
}

shape_status neph_bounds(const shape_set *set, shape_box *boxes, shape_error *error)
{
    /* For each list, the first cloud (plus one) that took its box at factor 1 and at the metaballs' factor. */
    size_t *first = calloc(set->list_count ? set->list_count : 1, 2 * sizeof *first);
    if (!first)
        return shape_error_memory(error);
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < set->cloud_count && !status; i++) {
        const shape_cloud *cloud = &set->clouds[i];
        const shape_primitives *list = shape_set_list_const(set, i);
        size_t *known = &first[2 * (size_t)cloud->list + (cloud->field.model == SHAPE_MODEL_METABALL)];
        boxes[i] = *known ? boxes[*known - 1] : shape_cloud_box(cloud, list);
        *known = *known ? *known : i + 1;
        if (!is_finite_box(&cloud->frame, boxes[i]))
            status = shape_error_set(
                error, SHAPE_ERROR_LIMIT,
                "cloud \"%s\" is too large or too far away for its numbers (scale it down)", cloud->name);
    }
    free(first);
    return status;
}
