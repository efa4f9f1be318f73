/* Fuzzes scenes: any text is refused in one line, or is a scene that can be written and read back to the same text. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shape/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void must(int truth)
{
    if (!truth)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    shape_error error = {SHAPE_OK, ""};
    shape_scene *scene, *again;
    shape_status status = shape_scene_decode(data, size, "fuzz", &scene, &error);
    if (status) {
        must(status == SHAPE_ERROR_FORMAT || status == SHAPE_ERROR_LIMIT);
        must(!strncmp(error.text, "fuzz:", 5) && !strchr(error.text, '\n'));
        return 0;
    }
    char *first, *second;
    size_t first_size, second_size;
    /* What is laid out for people may be longer than what was read; nothing else may keep it from being written. */
    status = shape_scene_encode(scene, &first, &first_size, &error);
    must(!status);
    must(!shape_scene_decode(first, first_size, "fuzz", &again, &error));
    must(!shape_scene_encode(again, &second, &second_size, &error));
    must(first_size == second_size && !memcmp(first, second, first_size));
    free(first);
    free(second);
    shape_scene_destroy(scene);
    shape_scene_destroy(again);
    return 0;
}
