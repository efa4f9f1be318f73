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
           !memcmp(type, "ELLI", 4) || !memcmp(type, "LAYR", 4);
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

/* What was found of a list: the last two supports that were asked for, and their boxes. */
typedef struct known_box {
    float support[2], margin[2];
    shape_box box[2];
    int count; /* how often the list was walked */
} known_box;

static bool find_known(const known_box *known, float support, float margin, shape_box *box)
{
    for (int i = 0; i < 2 && i < known->count; i++)
        if (known->support[i] == support && known->margin[i] == margin) {
            *box = known->box[i];
            return true;
        }
    return false;
}

/* *repeats counts the primitives of lists that are walked again. */
static shape_status find_box(const shape_cloud *cloud, const shape_primitives *list, known_box *known,
                             size_t *repeats, shape_box *box, shape_error *error)
{
    float support = shape_cloud_support(cloud, list), margin = cloud->field.detail.displace;
    bool layer = cloud->field.model == SHAPE_MODEL_LAYER,
         curved = layer && cloud->field.layer.planet_radius > 0;
    support = layer ? -support : support; /* a layer's box is not that of its supports */
    if (!curved && find_known(known, support, margin, box))
        return SHAPE_OK;
    *repeats += known->count ? shape_primitives_count(list) : 0;
    if (*repeats > NEPH_VISITS_MAX)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "too many clouds share a large list, each with a displacement, smoothness or "
                               "planet of its own (give them equal ones)");
    *box = shape_cloud_box(cloud, list);
    int place = known->count % 2;
    known->support[place] = curved ? 0 : support;
    known->margin[place] = margin;
    known->box[place] = *box;
    known->count += known->count < 1000 ? 1 : -1;
    return SHAPE_OK;
}

shape_status shape_neph_bounds(const shape_set *set, shape_box *boxes, shape_error *error)
{
    size_t repeats = 0;
    known_box *known = calloc(set->list_count ? set->list_count : 1, sizeof *known);
    if (!known)
        return shape_error_memory(error);
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < set->cloud_count && !status; i++) {
        const shape_cloud *cloud = &set->clouds[i];
        status =
            find_box(cloud, shape_set_list_const(set, i), &known[cloud->list], &repeats, &boxes[i], error);
        if (!status && !is_finite_box(&cloud->frame, boxes[i]))
            status = shape_error_set(
                error, SHAPE_ERROR_LIMIT,
                "cloud \"%s\" is too large or too far away for its numbers (scale it down)", cloud->name);
    }
    free(known);
    return status;
}
