/* A set as the bytes of a .neph file (docs/neph-format.md). The size is known before the first byte is written, the
 * memory comes zeroed, and chunks follow one another in the order of the table: CLUD, TEXT, LAYR where
 * a cloud needs it, the lists, the extras. */
#include "shape/neph.h"

#include <stdlib.h>

#include "file/neph_layout.h"

/* What is written where. */
typedef struct writer {
    const shape_set *set;
    const shape_box *boxes; /* one a cloud */
    unsigned char *bytes;
    unsigned char *entry; /* the table's next row */
    uint64_t offset;      /* where the next chunk goes */
} writer;

/* Where a cloud's two texts lie in the TEXT chunk, and where the next cloud's may begin. */
typedef struct text_place {
    uint64_t name, made_by, end;
} text_place;

/* Copies have the provenance of what they were copied from; it is stored once. */
static text_place place_texts(const shape_set *set, size_t cloud, text_place before)
{
    const char *made_by = set->clouds[cloud].made_by;
    bool same = cloud && !strcmp(made_by, set->clouds[cloud - 1].made_by);
    text_place place = {.name = before.end};
    uint64_t behind = place.name + strlen(set->clouds[cloud].name);
    place.made_by = same ? before.made_by : behind;
    place.end = behind + (same ? 0 : strlen(made_by));
    return place;
}

static uint64_t text_size(const shape_set *set)
{
    text_place place = {0};
    for (size_t i = 0; i < set->cloud_count; i++)
        place = place_texts(set, i, place);
    return place.end;
}

static shape_status check_text(const char *text, size_t room, size_t shortest, const char *what, size_t cloud,
                               shape_error *error)
{
    const char *end = memchr(text, 0, room);
    size_t length = end ? (size_t)(end - text) : 0;
    if (!end || length < shortest || !neph_text_is_plain(text, length))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "the %s of cloud %zu is empty, endless, or no plain UTF-8 (leave out control characters)", what,
            cloud);
    return SHAPE_OK;
}

static shape_status check_texts_and_extras(const shape_set *set, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < set->cloud_count && !status; i++) {
        const shape_cloud *cloud = &set->clouds[i];
        status = check_text(cloud->name, sizeof cloud->name, 1, "name", i, error);
        if (!status)
            status = check_text(cloud->made_by, sizeof cloud->made_by, 0, "made_by", i, error);
    }
    for (size_t i = 0; i < set->extra_count && !status; i++)
        if (!neph_type_is_valid(set->extras[i].type) || neph_type_is_known(set->extras[i].type))
            status = shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "extra chunk %zu has a type that it must not have (four letters or digits, not "
                "one of CLUD, TEXT, LAYR, SPHR, ELLI)",
                i);
    return status;
}

/* Adds count * size, padded, to *total; false where that passes what memory can hold. */
static bool add_chunk_size(uint64_t *total, uint64_t count, uint64_t size)
{
    if (count > (PTRDIFF_MAX - NEPH_ALIGN) / size || *total > PTRDIFF_MAX - NEPH_ALIGN - count * size)
        return false;
    *total = neph_aligned(*total + count * size);
    return true;
}

static bool list_has_spheres(const shape_primitives *list)
{
    /* An empty list still needs a chunk to exist in the file. */
    return list->sphere_count || !list->ellipsoid_count;
}

/* The number of chunks and the size of the whole file; false where a number of the format cannot hold them. */
static bool measure(const shape_set *set, uint64_t *chunks, uint64_t *size)
{
    size_t layers = neph_count_layers(set);
    *chunks = 2 + (uint64_t)(layers > 0) + (uint64_t)set->extra_count;
    for (size_t i = 0; i < set->list_count; i++)
        *chunks += (uint64_t)list_has_spheres(&set->lists[i]) + (set->lists[i].ellipsoid_count > 0);
    if (*chunks > UINT32_MAX || set->list_count > UINT32_MAX || set->cloud_count > UINT32_MAX ||
        text_size(set) > UINT32_MAX)
        return false;
    *size = NEPH_HEADER_SIZE + NEPH_TABLE_CRC_SIZE;
    bool fits = add_chunk_size(size, *chunks, NEPH_ENTRY_SIZE);
    *size += NEPH_CLOUDS_HEAD;
    fits = fits && add_chunk_size(size, set->cloud_count, NEPH_CLOUD_RECORD) &&
           add_chunk_size(size, text_size(set), 1);
    *size += layers ? NEPH_LAYERS_HEAD : 0;
    fits = fits && add_chunk_size(size, layers, NEPH_LAYER_RECORD);
    for (size_t i = 0; i < set->list_count && fits; i++)
        fits = add_chunk_size(size, set->lists[i].sphere_count, NEPH_SPHERE_SIZE) &&
               add_chunk_size(size, set->lists[i].ellipsoid_count, NEPH_ELLIPSOID_SIZE);
    for (size_t i = 0; i < set->extra_count && fits; i++)
        fits = add_chunk_size(size, set->extras[i].size, 1);
    return fits;
}

static unsigned char *chunk_bytes(const writer *w)
{
    return w->bytes + w->offset;
}

/* Enters the chunk whose `length` bytes stand at w->offset into the table. */
static void end_chunk(writer *w, const char type[4], uint32_t flags, uint32_t parameter, uint64_t length)
{
    memcpy(w->entry + NEPH_ENTRY_TYPE, type, 4);
    neph_put_u32(w->entry + NEPH_ENTRY_FLAGS, flags);
    neph_put_u32(w->entry + NEPH_ENTRY_PARAMETER, parameter);
    neph_put_u32(w->entry + NEPH_ENTRY_CRC, shape_crc32(chunk_bytes(w), (size_t)length));
    neph_put_u64(w->entry + NEPH_ENTRY_OFFSET, w->offset);
    neph_put_u64(w->entry + NEPH_ENTRY_LENGTH, length);
    w->entry += NEPH_ENTRY_SIZE;
    w->offset = neph_aligned(w->offset + length);
}

static void put_box(unsigned char *to, shape_box box)
{
    const float values[6] = {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
    neph_put_floats(to, values, 6);
}

static void put_cloud(unsigned char *to, const shape_cloud *cloud, shape_box box, text_place place)
{
    const shape_field *field = &cloud->field;
    const shape_medium *medium = &cloud->medium;
    for (int i = 0; i < 12; i++)
        neph_put_f64(to + NEPH_CLOUD_FRAME + 8 * i, cloud->frame.m[i / 4][i % 4]);
    neph_put_u64(to + NEPH_CLOUD_SEED, cloud->seed);
    neph_put_u64(to + NEPH_CLOUD_NOISE_SEED, field->seed);
    put_box(to + NEPH_CLOUD_BOX, box);
    neph_put_u32(to + NEPH_CLOUD_LIST, cloud->list);
    neph_put_u32(to + NEPH_CLOUD_NAME, (uint32_t)place.name);
    neph_put_u32(to + NEPH_CLOUD_NAME + 4, (uint32_t)strlen(cloud->name));
    neph_put_u32(to + NEPH_CLOUD_MADE_BY, (uint32_t)place.made_by);
    neph_put_u32(to + NEPH_CLOUD_MADE_BY + 4, (uint32_t)strlen(cloud->made_by));
    neph_put_u32(to + NEPH_CLOUD_MODEL, (uint32_t)field->model);
    neph_put_u32(to + NEPH_CLOUD_OCTAVES, (uint32_t)field->octaves);
    neph_put_u32(to + NEPH_CLOUD_PHASE, (uint32_t)medium->phase);
    neph_put_f32(to + NEPH_CLOUD_KAPPA, field->kappa);
    neph_put_f32(to + NEPH_CLOUD_NOISE_SCALE, field->noise_scale);
    neph_put_f32(to + NEPH_CLOUD_EDGE, field->edge);
    neph_put_f32(to + NEPH_CLOUD_EXTINCTION, medium->extinction);
    neph_put_f32(to + NEPH_CLOUD_ALBEDO, medium->albedo);
    neph_put_f32(to + NEPH_CLOUD_G, medium->g);
    neph_put_f32(to + NEPH_CLOUD_G2, medium->g2);
    neph_put_f32(to + NEPH_CLOUD_LOBE_MIX, medium->lobe_mix);
    neph_put_f32(to + NEPH_CLOUD_DROPLET, medium->droplet);
}

static void put_clouds(writer *w)
{
    const shape_set *set = w->set;
    unsigned char *to = chunk_bytes(w);
    neph_put_u32(to + NEPH_CLOUDS_RECORD_SIZE, NEPH_CLOUD_RECORD);
    neph_put_u32(to + NEPH_CLOUDS_COUNT, (uint32_t)set->cloud_count);
    neph_put_u32(to + NEPH_CLOUDS_LISTS, (uint32_t)set->list_count);
    to += NEPH_CLOUDS_HEAD;
    text_place place = {0};
    for (size_t i = 0; i < set->cloud_count; i++, to += NEPH_CLOUD_RECORD) {
        place = place_texts(set, i, place);
        put_cloud(to, &set->clouds[i], w->boxes[i], place);
    }
    end_chunk(w, "CLUD", NEPH_FLAG_REQUIRED, 0, (uint64_t)(to - chunk_bytes(w)));
}

static void put_texts(writer *w)
{
    text_place place = {0};
    for (size_t i = 0; i < w->set->cloud_count; i++) {
        const shape_cloud *cloud = &w->set->clouds[i];
        place = place_texts(w->set, i, place);
        memcpy(chunk_bytes(w) + place.name, cloud->name, strlen(cloud->name));
        memcpy(chunk_bytes(w) + place.made_by, cloud->made_by, strlen(cloud->made_by));
    }
    end_chunk(w, "TEXT", NEPH_FLAG_REQUIRED, 0, place.end);
}

static void put_layers(writer *w)
{
    const shape_set *set = w->set;
    size_t layers = neph_count_layers(set);
    if (!layers)
        return;
    unsigned char *to = chunk_bytes(w);
    neph_put_u32(to + NEPH_LAYERS_RECORD_SIZE, NEPH_LAYER_RECORD);
    neph_put_u32(to + NEPH_LAYERS_COUNT, (uint32_t)layers);
    to += NEPH_LAYERS_HEAD;
    for (size_t i = 0; i < set->cloud_count; i++)
        if (neph_needs_layer(&set->clouds[i].field)) {
            neph_put_layer(to, (uint32_t)i, &set->clouds[i].field);
            to += NEPH_LAYER_RECORD;
        }
    end_chunk(w, "LAYR", NEPH_FLAG_REQUIRED, 0, (uint64_t)(to - chunk_bytes(w)));
}

static void put_ellipsoids(unsigned char *to, const shape_primitives *list)
{
    neph_put_floats(to, (const float *)(const void *)list->ellipsoids, 12 * list->ellipsoid_count);
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        memset(to + i * NEPH_ELLIPSOID_SIZE + 12, 0, 4);
        memset(to + i * NEPH_ELLIPSOID_SIZE + 28, 0, 4);
    }
}

static void put_list(writer *w, size_t index)
{
    const shape_primitives *list = &w->set->lists[index];
    if (list_has_spheres(list)) {
        neph_put_floats(chunk_bytes(w), (const float *)(const void *)list->spheres, 4 * list->sphere_count);
        end_chunk(w, "SPHR", NEPH_FLAG_REQUIRED, (uint32_t)index,
                  (uint64_t)list->sphere_count * NEPH_SPHERE_SIZE);
    }
    if (list->ellipsoid_count) {
        put_ellipsoids(chunk_bytes(w), list);
        end_chunk(w, "ELLI", NEPH_FLAG_REQUIRED, (uint32_t)index,
                  (uint64_t)list->ellipsoid_count * NEPH_ELLIPSOID_SIZE);
    }
}

static void put_extras(writer *w)
{
    for (size_t i = 0; i < w->set->extra_count; i++) {
        const shape_extra *extra = &w->set->extras[i];
        if (extra->size)
            memcpy(chunk_bytes(w), extra->bytes, extra->size);
        end_chunk(w, extra->type, 0, extra->list, extra->size);
    }
}

/* The lowest minor version that has all that is in the file, so that files without layers stay as they were. */
static void put_header(unsigned char *to, unsigned minor, uint64_t chunks, uint64_t size)
{
    memcpy(to + NEPH_AT_MAGIC, NEPH_MAGIC, 8);
    neph_put_u16(to + NEPH_AT_MAJOR, SHAPE_NEPH_MAJOR);
    neph_put_u16(to + NEPH_AT_MINOR, (uint16_t)minor);
    neph_put_u32(to + NEPH_AT_CHUNKS, (uint32_t)chunks);
    neph_put_u64(to + NEPH_AT_FILE_SIZE, size);
}

static void put_file(const shape_set *set, const shape_box *boxes, uint64_t chunks, uint64_t size,
                     unsigned char *bytes)
{
    uint64_t table_end = NEPH_HEADER_SIZE + chunks * NEPH_ENTRY_SIZE;
    writer w = {.set = set,
                .boxes = boxes,
                .bytes = bytes,
                .entry = bytes + NEPH_HEADER_SIZE,
                .offset = neph_aligned(table_end + NEPH_TABLE_CRC_SIZE)};
    put_header(bytes, neph_count_layers(set) ? 1 : 0, chunks, size);
    put_clouds(&w);
    put_texts(&w);
    put_layers(&w);
    for (size_t i = 0; i < set->list_count; i++)
        put_list(&w, i);
    put_extras(&w);
    neph_put_u32(bytes + table_end, shape_crc32(bytes, (size_t)table_end));
}

/* A .neph holds primitives and stays small. */
static shape_status check_no_grids(const shape_set *set, shape_error *error)
{
    for (size_t i = 0; i < set->cloud_count; i++)
        if (shape_set_list_const(set, i)->grid)
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "cloud \"%s\" is a voxel grid, which no .neph holds (make primitives of it "
                "with neph-vdb)",
                set->clouds[i].name);
    return SHAPE_OK;
}

shape_status shape_neph_encode(const shape_set *set, unsigned char **bytes, size_t *size, shape_error *error)
{
    shape_status status = shape_set_check(set, error);
    if (!status)
        status = check_texts_and_extras(set, error);
    if (!status)
        status = check_no_grids(set, error);
    if (status)
        return status;
    uint64_t chunks, total;
    if (!measure(set, &chunks, &total))
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "the set is too large for a .neph file (split it)");
    shape_box *boxes = malloc((set->cloud_count ? set->cloud_count : 1) * sizeof *boxes);
    unsigned char *out = calloc((size_t)total, 1);
    if (!boxes || !out)
        status = shape_error_memory(error);
    if (!status)
        status = shape_neph_bounds(set, boxes, error);
    if (!status) {
        put_file(set, boxes, chunks, total, out);
        *bytes = out;
        *size = (size_t)total;
        out = NULL;
    }
    free(boxes);
    free(out);
    return status;
}
