// ask_cloud FILE: prints how many primitives the first cloud has, and its density in the middle of its largest sphere.
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <shape/file.h>
#include <shape/neph.h>
#include <shape/volume.h>

int main(int argc, char **argv)
{
    shape_error error;
    unsigned char *bytes = nullptr;
    std::size_t size = 0;
    shape_set *set = nullptr;
    shape_volume *volume = nullptr;
    if (argc != 2)
        return 2;
    if (shape_file_read(argv[1], 1 << 24, &bytes, &size, &error) ||
        shape_neph_decode(bytes, size, &set, &error)) {
        std::fprintf(stderr, "ask_cloud: %s\n", error.text);
        return 1;
    }
    std::free(bytes);
    std::unique_ptr<shape_set, void (*)(shape_set *)> owned(set, shape_set_destroy);
    set->clouds[0].field.model = SHAPE_MODEL_UNIFORM;
    if (shape_volume_create(set, &volume, &error)) {
        std::fprintf(stderr, "ask_cloud: %s\n", error.text);
        return 1;
    }
    const shape_primitives *list = shape_set_list_const(set, 0);
    shape_sphere largest = list->spheres[0];
    for (std::size_t i = 1; i < list->sphere_count; i++)
        if (list->spheres[i].radius > largest.radius)
            largest = list->spheres[i];
    std::printf("%zu %g\n", shape_primitives_count(list),
                double(shape_cloud_density(&volume->clouds[0], {largest.x, largest.y, largest.z})));
    shape_volume_destroy(volume);
}
