/* For the tests of the .neph format: a file in memory, its chunks, and its CRCs after bytes were changed on purpose. */
#ifndef NEPH_FILE_H
#define NEPH_FILE_H

#include "neph_sample.h"

#include "file/neph_layout.h"

/* A file in memory. */
typedef struct file {
    unsigned char *bytes;
    size_t size;
} file;

static inline file encode(const shape_set *set)
{
    shape_error error;
    file f;
    must(shape_neph_encode(set, &f.bytes, &f.size, &error), &error);
    return f;
}

/* Encodes and destroys. */
static inline file encode_once(shape_set *set)
{
    file f = encode(set);
    shape_set_destroy(set);
    return f;
}

static inline shape_set *decode(file f)
{
    shape_error error;
    shape_set *set = NULL;
    must(shape_neph_decode(f.bytes, f.size, &set, &error), &error);
    return set;
}

static inline unsigned char *entry_of(file f, size_t chunk)
{
    return f.bytes + NEPH_HEADER_SIZE + chunk * NEPH_ENTRY_SIZE;
}

static inline unsigned char *chunk_of(file f, size_t chunk)
{
    return f.bytes + neph_get_u64(entry_of(f, chunk) + NEPH_ENTRY_OFFSET);
}

/* Makes every CRC right again, where the places are still sane. */
static inline void reseal(file f)
{
    uint64_t chunks = neph_get_u32(f.bytes + NEPH_AT_CHUNKS);
    uint64_t table_end = NEPH_HEADER_SIZE + chunks * NEPH_ENTRY_SIZE;
    if (table_end + NEPH_TABLE_CRC_SIZE > f.size)
        return;
    for (size_t i = 0; i < chunks; i++) {
        unsigned char *entry = entry_of(f, i);
        uint64_t offset = neph_get_u64(entry + NEPH_ENTRY_OFFSET),
                 length = neph_get_u64(entry + NEPH_ENTRY_LENGTH);
        if (offset <= f.size && length <= f.size - offset)
            neph_put_u32(entry + NEPH_ENTRY_CRC, shape_crc32(f.bytes + offset, (size_t)length));
    }
    neph_put_u32(f.bytes + table_end, shape_crc32(f.bytes, (size_t)table_end));
}

/* The bytes are refused as a bad format, in one line that holds one of the texts between |. */
static inline void assert_refused(file f, const char *texts)
{
    shape_error error = {0};
    shape_set *set = NULL;
    assert_int_equal(shape_neph_decode(f.bytes, f.size, &set, &error), SHAPE_ERROR_FORMAT);
    assert_int_equal(error.status, SHAPE_ERROR_FORMAT);
    assert_null(set);
    assert_null(strchr(error.text, '\n'));
    char text[128];
    for (const char *at = texts; *at;) {
        size_t length = strcspn(at, "|");
        snprintf(text, sizeof text, "%.*s", (int)length, at);
        if (strstr(error.text, text))
            return;
        at += length + (at[length] == '|');
    }
    fail_msg("\"%s\" does not say \"%s\"", error.text, texts);
}

#endif
