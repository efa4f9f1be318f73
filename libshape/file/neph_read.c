/* The bytes of a .neph file as a set (docs/neph-format.md). The bytes come from strangers: header, table, layout and
 * every CRC are checked before any memory is taken, and every count is paid for by bytes that are there. */
#include "shape/neph.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "file/neph_layout.h"

typedef struct reader {
    const unsigned char *bytes;
    uint64_t size;
    uint32_t chunk_count;
    unsigned minor;
    uint32_t cloud_count, list_count, record_size;
    const unsigned char *layers; /* the LAYR chunk, or NULL */
    shape_error *error;
} reader;

/* A row of the table. */
typedef struct chunk {
    char type[5]; /* ended by a zero */
    uint32_t index, flags, parameter, crc;
    uint64_t offset, length;
} chunk;

static chunk get_chunk(const reader *r, uint32_t index)
{
    const unsigned char *entry = r->bytes + NEPH_HEADER_SIZE + (uint64_t)index * NEPH_ENTRY_SIZE;
    chunk c = {.index = index,
               .flags = neph_get_u32(entry + NEPH_ENTRY_FLAGS),
               .parameter = neph_get_u32(entry + NEPH_ENTRY_PARAMETER),
               .crc = neph_get_u32(entry + NEPH_ENTRY_CRC),
               .offset = neph_get_u64(entry + NEPH_ENTRY_OFFSET),
               .length = neph_get_u64(entry + NEPH_ENTRY_LENGTH)};
    memcpy(c.type, entry + NEPH_ENTRY_TYPE, 4);
    return c;
}

static shape_status refuse(const reader *r, const char *what)
{
    return shape_error_set(r->error, SHAPE_ERROR_FORMAT, "%s", what);
}

static shape_status refuse_chunk(const reader *r, const chunk *c, const char *what)
{
    return shape_error_set(r->error, SHAPE_ERROR_FORMAT, "chunk %lu (%s, at byte %llu) %s",
                           (unsigned long)c->index, c->type, (unsigned long long)c->offset, what);
}

/* Refuses content that is well-formed but wrong; a newer version may know better. */
static shape_status refuse_cloud(const reader *r, uint32_t cloud, const char *what)
{
    const char *hint =
        r->minor > SHAPE_NEPH_MINOR ? "; the file is of a newer version (update the program)" : "";
    return shape_error_set(r->error, SHAPE_ERROR_FORMAT, "cloud %lu: %s%s", (unsigned long)cloud, what, hint);
}

static shape_status check_magic(const reader *r)
{
    size_t shown = r->size < 8 ? (size_t)r->size : 8;
    if (!r->size)
        return refuse(r, "the file is empty (a .neph is made by neph-lsys, neph-gauss and others)");
    if (!memcmp(r->bytes, NEPH_MAGIC, shown))
        return SHAPE_OK;
    if (r->size >= 4 && !memcmp(r->bytes, NEPH_MAGIC, 4))
        return refuse(r, "byte 4: line ends were changed on the way (copy the file again, as binary)");
    return refuse(r, "byte 0: not a .neph file (a .neph is made by neph-lsys, neph-gauss and others)");
}

static shape_status refuse_truncated(const reader *r, uint64_t whole)
{
    return shape_error_set(
        r->error, SHAPE_ERROR_FORMAT, "truncated at byte %llu of %s%llu (copy the file again)",
        (unsigned long long)r->size, whole == NEPH_HEADER_SIZE ? "at least " : "", (unsigned long long)whole);
}

static shape_status check_header(reader *r)
{
    shape_status status = check_magic(r);
    if (status)
        return status;
    if (r->size < NEPH_HEADER_SIZE)
        return refuse_truncated(r, NEPH_HEADER_SIZE);
    unsigned major = neph_get_u16(r->bytes + NEPH_AT_MAJOR);
    r->minor = neph_get_u16(r->bytes + NEPH_AT_MINOR);
    if (major != SHAPE_NEPH_MAJOR)
        return shape_error_set(r->error, SHAPE_ERROR_FORMAT,
                               "byte %d: format version %u.%u, but only %d.x is known (%s)", NEPH_AT_MAJOR,
                               major, r->minor, SHAPE_NEPH_MAJOR,
                               major > SHAPE_NEPH_MAJOR ? "update the program" : "copy the file again");
    uint64_t whole = neph_get_u64(r->bytes + NEPH_AT_FILE_SIZE);
    if (r->size < whole)
        return refuse_truncated(r, whole);
    if (r->size > whole)
        return shape_error_set(r->error, SHAPE_ERROR_FORMAT,
                               "byte %llu: %llu bytes too many follow the file's end (copy the file again)",
                               (unsigned long long)whole, (unsigned long long)(r->size - whole));
    r->chunk_count = neph_get_u32(r->bytes + NEPH_AT_CHUNKS);
    if (r->chunk_count < 2 ||
        (uint64_t)r->chunk_count * NEPH_ENTRY_SIZE + NEPH_TABLE_CRC_SIZE > r->size - NEPH_HEADER_SIZE)
        return refuse(r, "byte 12: the number of chunks does not fit the file (copy the file again)");
    uint64_t table_end = NEPH_HEADER_SIZE + (uint64_t)r->chunk_count * NEPH_ENTRY_SIZE;
    if (neph_get_u32(r->bytes + table_end) != shape_crc32(r->bytes, (size_t)table_end))
        return refuse(r, "header or chunk table damaged: their CRC is wrong (copy the file again)");
    return SHAPE_OK;
}

static bool is_zero(const unsigned char *bytes, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++)
        if (bytes[i])
            return false;
    return true;
}

/* The next chunk begins where the last one's padding ends: no gap, no overlap, nothing hidden. */
static shape_status check_place(const reader *r, const chunk *c, uint64_t expected)
{
    if (!neph_type_is_valid(c->type))
        return shape_error_set(r->error, SHAPE_ERROR_FORMAT,
                               "chunk %lu has a type that is not four letters or digits",
                               (unsigned long)c->index);
    if (c->flags & ~(uint32_t)NEPH_FLAG_REQUIRED)
        return refuse_chunk(r, c, "has flags that this version does not know (update the program)");
    if (c->offset != expected || c->length > r->size - expected ||
        neph_aligned(c->length) > r->size - expected)
        return refuse_chunk(r, c, "is not where it must be (make the file again)");
    uint64_t padding = neph_aligned(c->length) - c->length;
    if (!is_zero(r->bytes + c->offset + c->length, padding))
        return refuse_chunk(r, c, "is padded with bytes that are not zero (copy the file again)");
    if (shape_crc32(r->bytes + c->offset, (size_t)c->length) != c->crc)
        return refuse_chunk(r, c, "is damaged: its CRC is wrong (copy the file again)");
    return SHAPE_OK;
}

/* What the chunks before have brought. */
typedef struct order {
    uint32_t lists;       /* how many have begun */
    bool ellipsoids_done; /* the last list has its ELLI chunk */
    bool layers;
} order;

/* Primitive chunks come by list: SPHR 0, ELLI 0, SPHR 1, ...; a list may lack either, not both. */
static shape_status check_primitives(const reader *r, const chunk *c, order *o)
{
    bool ellipsoids = c->type[0] == 'E';
    bool same = ellipsoids && o->lists && c->parameter == o->lists - 1 && !o->ellipsoids_done;
    if (!same && c->parameter != o->lists)
        return refuse_chunk(r, c,
                            "is out of order (lists must be numbered from 0, spheres before ellipsoids)");
    o->lists = c->parameter + 1;
    o->ellipsoids_done = ellipsoids;
    if (c->length % (ellipsoids ? NEPH_ELLIPSOID_SIZE : NEPH_SPHERE_SIZE))
        return refuse_chunk(r, c, "does not hold whole primitives (make the file again)");
    return SHAPE_OK;
}

static shape_status check_layers(reader *r, const chunk *c, order *o)
{
    const unsigned char *bytes = r->bytes + c->offset;
    if (o->layers)
        return refuse_chunk(r, c, "comes a second time (make the file again)");
    o->layers = true;
    if (c->length < NEPH_LAYERS_HEAD)
        return refuse_chunk(r, c, "is too short (make the file again)");
    uint32_t size = neph_get_u32(bytes + NEPH_LAYERS_RECORD_SIZE);
    uint32_t count = neph_get_u32(bytes + NEPH_LAYERS_COUNT);
    if (size < NEPH_LAYER_RECORD || size > NEPH_RECORD_MAX || size % 8)
        return refuse_chunk(r, c, "has records of a size that it must not have (make the file again)");
    if (c->length - NEPH_LAYERS_HEAD != (uint64_t)count * size)
        return refuse_chunk(r, c, "declares a number of records that it does not hold (make the file again)");
    r->layers = bytes;
    return SHAPE_OK;
}

static shape_status check_kind(reader *r, const chunk *c, order *o)
{
    static const char *const first[2] = {"CLUD", "TEXT"};
    if ((c->index < 2 && strcmp(c->type, first[c->index])) ||
        (c->index >= 2 && (!strcmp(c->type, first[0]) || !strcmp(c->type, first[1]))))
        return refuse_chunk(r, c, "is out of order (CLUD must come first, then TEXT, each once)");
    bool required = c->flags & NEPH_FLAG_REQUIRED;
    if (!neph_type_is_known(c->type))
        return required ? refuse_chunk(r, c, "is required and not known to this version (update the program)")
                        : SHAPE_OK;
    if (!required)
        return refuse_chunk(r, c, "lacks the flag \"required\" (make the file again)");
    if (!strcmp(c->type, "LAYR"))
        return check_layers(r, c, o);
    return c->index < 2 ? SHAPE_OK : check_primitives(r, c, o);
}

static shape_status check_cloud_head(reader *r)
{
    chunk c = get_chunk(r, 0);
    const unsigned char *bytes = r->bytes + c.offset;
    if (c.length < NEPH_CLOUDS_HEAD)
        return refuse_chunk(r, &c, "is too short (make the file again)");
    r->record_size = neph_get_u32(bytes + NEPH_CLOUDS_RECORD_SIZE);
    r->cloud_count = neph_get_u32(bytes + NEPH_CLOUDS_COUNT);
    r->list_count = neph_get_u32(bytes + NEPH_CLOUDS_LISTS);
    if (r->record_size < NEPH_CLOUD_RECORD || r->record_size > NEPH_RECORD_MAX || r->record_size % 8)
        return refuse_chunk(r, &c, "has records of a size that it must not have (make the file again)");
    if (c.length - NEPH_CLOUDS_HEAD != (uint64_t)r->cloud_count * r->record_size)
        return refuse_chunk(r, &c, "declares a number of clouds that it does not hold (make the file again)");
    return SHAPE_OK;
}

static shape_status check_chunks(reader *r)
{
    order o = {0};
    uint64_t table_end = NEPH_HEADER_SIZE + (uint64_t)r->chunk_count * NEPH_ENTRY_SIZE + NEPH_TABLE_CRC_SIZE;
    uint64_t expected = neph_aligned(table_end);
    if (expected > r->size || !is_zero(r->bytes + table_end, expected - table_end))
        return refuse(r, "the chunk table is not padded with zeros (copy the file again)");
    for (uint32_t i = 0; i < r->chunk_count; i++) {
        chunk c = get_chunk(r, i);
        shape_status status = check_place(r, &c, expected);
        if (!status)
            status = check_kind(r, &c, &o);
        if (status)
            return status;
        expected += neph_aligned(c.length);
    }
    if (expected != r->size)
        return refuse(r, "bytes follow the last chunk (make the file again)");
    shape_status status = check_cloud_head(r);
    if (!status && r->list_count != o.lists)
        status = refuse(r, "chunk 0 (CLUD) declares lists that are not those there (make the file again)");
    return status;
}

/* Copies a text out of the TEXT chunk; `to` has room for longest + 1. */
static bool get_text(const reader *r, const unsigned char *place, size_t shortest, size_t longest, char *to)
{
    chunk texts = get_chunk(r, 1);
    uint64_t offset = neph_get_u32(place), length = neph_get_u32(place + 4);
    if (length < shortest || length > longest || offset + length > texts.length)
        return false;
    const char *from = (const char *)(r->bytes + texts.offset + offset);
    if (!neph_text_is_plain(from, (size_t)length))
        return false;
    memcpy(to, from, (size_t)length);
    to[length] = 0;
    return true;
}

static void get_field_and_medium(const unsigned char *from, shape_cloud *cloud)
{
    cloud->field = (shape_field){.model = (shape_model)neph_get_small(from + NEPH_CLOUD_MODEL),
                                 .kappa = neph_get_f32(from + NEPH_CLOUD_KAPPA),
                                 .octaves = neph_get_small(from + NEPH_CLOUD_OCTAVES),
                                 .noise_scale = neph_get_f32(from + NEPH_CLOUD_NOISE_SCALE),
                                 .edge = neph_get_f32(from + NEPH_CLOUD_EDGE),
                                 .seed = neph_get_u64(from + NEPH_CLOUD_NOISE_SEED),
                                 .layer = shape_layer_defaults()};
    cloud->medium = (shape_medium){.extinction = neph_get_f32(from + NEPH_CLOUD_EXTINCTION),
                                   .albedo = neph_get_f32(from + NEPH_CLOUD_ALBEDO),
                                   .phase = (shape_phase_kind)neph_get_small(from + NEPH_CLOUD_PHASE),
                                   .g = neph_get_f32(from + NEPH_CLOUD_G),
                                   .g2 = neph_get_f32(from + NEPH_CLOUD_G2),
                                   .lobe_mix = neph_get_f32(from + NEPH_CLOUD_LOBE_MIX),
                                   .droplet = neph_get_f32(from + NEPH_CLOUD_DROPLET)};
}

static const unsigned char *get_record(const reader *r, uint32_t index)
{
    return r->bytes + get_chunk(r, 0).offset + NEPH_CLOUDS_HEAD + (uint64_t)index * r->record_size;
}

static shape_status get_cloud(const reader *r, uint32_t index, shape_cloud *cloud)
{
    const unsigned char *from = get_record(r, index);
    memset(cloud, 0, sizeof *cloud);
    for (int i = 0; i < 12; i++)
        cloud->frame.m[i / 4][i % 4] = neph_get_f64(from + NEPH_CLOUD_FRAME + 8 * i);
    cloud->seed = neph_get_u64(from + NEPH_CLOUD_SEED);
    cloud->list = neph_get_u32(from + NEPH_CLOUD_LIST);
    get_field_and_medium(from, cloud);
    if (!get_text(r, from + NEPH_CLOUD_NAME, 1, SHAPE_NAME_MAX, cloud->name))
        return refuse_cloud(r, index, "its name is not 1 to 63 bytes of plain UTF-8 in the TEXT chunk");
    if (!get_text(r, from + NEPH_CLOUD_MADE_BY, 0, SHAPE_MADE_BY_MAX, cloud->made_by))
        return refuse_cloud(r, index,
                            "its made_by is not at most 255 bytes of plain UTF-8 in the TEXT chunk");
    if (cloud->list >= r->list_count)
        return refuse_cloud(r, index, "it names a list that is not there");
    shape_error inner;
    if (shape_field_check(&cloud->field, &inner) || shape_medium_check(&cloud->medium, &inner))
        return refuse_cloud(r, index, inner.text);
    return SHAPE_OK;
}

static shape_status get_clouds(const reader *r, shape_set *set)
{
    if (shape_array_reserve((void **)&set->clouds, &set->cloud_capacity, r->cloud_count, sizeof *set->clouds,
                            r->error))
        return SHAPE_ERROR_MEMORY;
    for (uint32_t i = 0; i < r->cloud_count; i++) {
        shape_status status = get_cloud(r, i, &set->clouds[i]);
        if (status)
            return status;
        set->cloud_count = i + 1;
    }
    return SHAPE_OK;
}

/* The settings of the LAYR chunk go to the clouds that it names, in rising order. */
static shape_status get_layers(const reader *r, shape_set *set)
{
    if (!r->layers)
        return SHAPE_OK;
    uint32_t size = neph_get_u32(r->layers + NEPH_LAYERS_RECORD_SIZE), next = 0;
    uint32_t count = neph_get_u32(r->layers + NEPH_LAYERS_COUNT);
    for (uint32_t i = 0; i < count; i++) {
        const unsigned char *from = r->layers + NEPH_LAYERS_HEAD + (uint64_t)i * size;
        uint32_t cloud = neph_get_u32(from + NEPH_LAYER_CLOUD);
        if (cloud >= r->cloud_count || cloud < next)
            return refuse(r, "the LAYR chunk names a cloud that is not there, or not in order (make the file "
                             "again)");
        next = cloud + 1;
        shape_error inner;
        neph_get_layer(from, &set->clouds[cloud].field);
        if (shape_field_check(&set->clouds[cloud].field, &inner))
            return refuse_cloud(r, cloud, inner.text);
    }
    return SHAPE_OK;
}

static shape_status get_spheres(const reader *r, const chunk *c, shape_primitives *list)
{
    size_t count = (size_t)(c->length / NEPH_SPHERE_SIZE);
    if (shape_primitives_reserve(list, count, 0, r->error))
        return SHAPE_ERROR_MEMORY;
    neph_get_floats((float *)(void *)list->spheres, r->bytes + c->offset, 4 * count);
    list->sphere_count = count;
    return SHAPE_OK;
}

static shape_status get_ellipsoids(const reader *r, const chunk *c, shape_primitives *list)
{
    size_t count = (size_t)(c->length / NEPH_ELLIPSOID_SIZE);
    if (shape_primitives_reserve(list, 0, count, r->error))
        return SHAPE_ERROR_MEMORY;
    neph_get_floats((float *)(void *)list->ellipsoids, r->bytes + c->offset, 12 * count);
    for (size_t i = 0; i < count; i++)
        list->ellipsoids[i].pad0 = list->ellipsoids[i].pad1 = 0;
    list->ellipsoid_count = count;
    return SHAPE_OK;
}

static shape_status get_lists_and_extras(const reader *r, shape_set *set)
{
    if (shape_array_reserve((void **)&set->lists, &set->list_capacity, r->list_count, sizeof *set->lists,
                            r->error))
        return SHAPE_ERROR_MEMORY;
    if (r->list_count)
        memset(set->lists, 0, r->list_count * sizeof *set->lists);
    set->list_count = r->list_count;
    for (uint32_t i = 2; i < r->chunk_count; i++) {
        chunk c = get_chunk(r, i);
        shape_status status = SHAPE_OK;
        if (!strcmp(c.type, "SPHR"))
            status = get_spheres(r, &c, &set->lists[c.parameter]);
        else if (!strcmp(c.type, "ELLI"))
            status = get_ellipsoids(r, &c, &set->lists[c.parameter]);
        else if (strcmp(c.type, "LAYR"))
            status = shape_set_add_extra(set, c.type, c.parameter, r->bytes + c.offset, (size_t)c.length,
                                         r->error);
        if (status)
            return status;
    }
    return SHAPE_OK;
}

/* The stored box must be finite and hold the supports, but for another writer's rounding. */
static bool box_is_right(const unsigned char *stored, const shape_cloud *cloud, shape_box box)
{
    const float want[6] = {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
    float have[6], reach = 0;
    neph_get_floats(have, stored, 6);
    for (int i = 0; i < 6; i++) {
        if (!isfinite(have[i]))
            return false;
        reach = fmaxf(reach, fabsf(want[i]));
    }
    if (shape_box_is_empty(box) || cloud->field.model > SHAPE_MODEL_LAYER)
        return true;
    double tolerance = 1e-4 * (double)reach;
    for (int i = 0; i < 3; i++)
        if ((double)have[i] > want[i] + tolerance || (double)have[i + 3] < want[i + 3] - tolerance)
            return false;
    return true;
}

static shape_status check_boxes(const reader *r, const shape_set *set)
{
    shape_box *boxes = malloc((set->cloud_count ? set->cloud_count : 1) * sizeof *boxes);
    if (!boxes)
        return shape_error_memory(r->error);
    shape_status status = shape_neph_bounds(set, boxes, r->error);
    for (uint32_t i = 0; i < r->cloud_count && !status; i++)
        if (!box_is_right(get_record(r, i) + NEPH_CLOUD_BOX, &set->clouds[i], boxes[i]))
            status =
                refuse_cloud(r, i, "its bounding box does not hold its primitives (make the file again)");
    free(boxes);
    return status;
}

static shape_status get_set(const reader *r, shape_set *set)
{
    shape_status status = get_clouds(r, set);
    if (!status)
        status = get_layers(r, set);
    if (!status)
        status = get_lists_and_extras(r, set);
    if (!status)
        status = shape_set_check(set, r->error);
    if (!status)
        status = check_boxes(r, set);
    /* Wherever content is refused, it is the file that is wrong, not a caller's argument. */
    if (status && status != SHAPE_ERROR_MEMORY) {
        status = SHAPE_ERROR_FORMAT;
        if (r->error)
            r->error->status = status;
    }
    return status;
}

shape_status shape_neph_decode(const void *bytes, size_t size, shape_set **set, shape_error *error)
{
    reader r = {.bytes = bytes, .size = size, .error = error};
    shape_status status = check_header(&r);
    if (!status)
        status = check_chunks(&r);
    if (status)
        return status;
    shape_set *result = shape_set_create(error);
    if (!result)
        return SHAPE_ERROR_MEMORY;
    status = get_set(&r, result);
    if (status)
        shape_set_destroy(result);
    else
        *set = result;
    return status;
}

void shape_neph_version(const void *bytes, unsigned *major, unsigned *minor)
{
    const unsigned char *from = bytes;
    *major = neph_get_u16(from + NEPH_AT_MAJOR);
    *minor = neph_get_u16(from + NEPH_AT_MINOR);
}
