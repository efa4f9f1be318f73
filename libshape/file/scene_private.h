/* Private: between the files that read and write scenes. */
#ifndef SHAPE_FILE_SCENE_PRIVATE_H
#define SHAPE_FILE_SCENE_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>

enum { SCENE_NUMBER_MAX = 32 };

/* The shortest text that reads back as the same number. */
void scene_number_text(double value, char text[SCENE_NUMBER_MAX]);
/* The text that the reader makes of a JSON number, had text been written as one. */
int scene_number_is_plain(const char *text);

/* Of a picture's bytes: where the scene's text stands in them. False where there is none. */
bool scene_find_in_picture(const void **bytes, size_t *size);

#endif
