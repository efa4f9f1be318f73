/* make_picture FILE.png: a grey ramp of 16x1 pixels, by the installed shape_io. */
#include <stdio.h>
#include <stdlib.h>

#include <shape/file.h>
#include <shape/image.h>

int main(int argc, char **argv)
{
    shape_error error;
    unsigned char *bytes = NULL;
    size_t size;
    if (argc != 2)
        return 2;
    shape_image *image = shape_image_create(16, 1, &error);
    if (!image)
        return 1;
    for (int i = 0; i < 48; i++)
        image->pixels[i] = (float)(i / 3) / 15.0f;
    shape_image_options options = shape_image_options_defaults();
    if (shape_image_encode(image, SHAPE_IMAGE_PNG, &options, &bytes, &size, &error) ||
        shape_file_write(argv[1], bytes, size, &error)) {
        fprintf(stderr, "make_picture: %s\n", error.text);
        return 1;
    }
    free(bytes);
    shape_image_destroy(image);
    return 0;
}
