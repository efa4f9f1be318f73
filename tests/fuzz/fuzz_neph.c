/* Fuzzes the .neph reader. What is accepted must go round: encoded and decoded again, it gives the same bytes. The
 * mutator makes the CRCs right again in most inputs, or nothing behind them would ever be reached. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "file/neph_layout.h"
#include "shape/neph.h"

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

static void must(int truth)
{
    if (!truth)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    shape_error error = {0};
    shape_set *set = NULL;
    if (shape_neph_decode(data, size, &set, &error)) {
        must(!set && error.text[0] && !strchr(error.text, '\n'));
        return 0;
    }
    unsigned char *first, *second;
    size_t first_size, second_size;
    shape_set *again;
    must(!shape_neph_encode(set, &first, &first_size, &error));
    must(!shape_neph_decode(first, first_size, &again, &error));
    must(!shape_neph_encode(again, &second, &second_size, &error));
    must(first_size == second_size && !memcmp(first, second, first_size));
    shape_set_destroy(set);
    shape_set_destroy(again);
    free(first);
    free(second);
    return 0;
}

static void make_crcs_right(uint8_t *data, size_t size)
{
    if (size < NEPH_HEADER_SIZE)
        return;
    uint64_t chunks = neph_get_u32(data + NEPH_AT_CHUNKS);
    uint64_t table_end = NEPH_HEADER_SIZE + chunks * NEPH_ENTRY_SIZE;
    if (table_end + NEPH_TABLE_CRC_SIZE > size)
        return;
    for (uint64_t i = 0; i < chunks; i++) {
        uint8_t *entry = data + NEPH_HEADER_SIZE + i * NEPH_ENTRY_SIZE;
        uint64_t offset = neph_get_u64(entry + NEPH_ENTRY_OFFSET),
                 length = neph_get_u64(entry + NEPH_ENTRY_LENGTH);
        if (offset <= size && length <= size - offset)
            neph_put_u32(entry + NEPH_ENTRY_CRC, shape_crc32(data + offset, (size_t)length));
    }
    neph_put_u32(data + table_end, shape_crc32(data, (size_t)table_end));
}

/* Lays the chunks out one behind the other, as far as the bytes go, with padding and file size as they must be. */
static void make_places_right(uint8_t *data, size_t size)
{
    if (size < NEPH_HEADER_SIZE)
        return;
    uint64_t chunks = neph_get_u32(data + NEPH_AT_CHUNKS);
    uint64_t table_end = NEPH_HEADER_SIZE + chunks * NEPH_ENTRY_SIZE + NEPH_TABLE_CRC_SIZE;
    uint64_t offset = neph_aligned(table_end);
    if (offset > size)
        return;
    memset(data + table_end, 0, offset - table_end);
    neph_put_u64(data + NEPH_AT_FILE_SIZE, size);
    for (uint64_t i = 0; i < chunks; i++) {
        uint8_t *entry = data + NEPH_HEADER_SIZE + i * NEPH_ENTRY_SIZE;
        uint64_t length = neph_get_u64(entry + NEPH_ENTRY_LENGTH), room = size - offset;
        if (length > room || i + 1 == chunks)
            length = room < length || room - length >= NEPH_ALIGN ? room : length;
        neph_put_u64(entry + NEPH_ENTRY_OFFSET, offset);
        neph_put_u64(entry + NEPH_ENTRY_LENGTH, length);
        uint64_t end = neph_aligned(offset + length) < size ? neph_aligned(offset + length) : size;
        memset(data + offset + length, 0, end - offset - length);
        offset = end;
    }
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    size = LLVMFuzzerMutate(data, size, max_size);
    if (seed % 4 == 0)
        size -= size % NEPH_ALIGN;
    if (seed % 4 <= 1)
        make_places_right(data, size);
    if (seed % 8 != 7)
        make_crcs_right(data, size);
    return size;
}
