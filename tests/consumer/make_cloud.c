/* make_cloud FILE: a Gaussian heap of spheres as a .neph file, by the installed library. */
#include <stdio.h>
#include <stdlib.h>

#include <shape/file.h>
#include <shape/gaussian.h>
#include <shape/neph.h>

static shape_status make(const char *path, shape_error *error)
{
    unsigned char *bytes = NULL;
    size_t size, cloud;
    shape_gaussian options = shape_gaussian_defaults();
    shape_gaussian_report report;
    shape_set *set = shape_set_create(error);
    if (!set)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_set_add_cloud(set, "heap", &cloud, error);
    if (!status)
        status = shape_gaussian_make(&options, 1, shape_set_list(set, cloud), &report, error);
    if (!status)
        status = shape_cloud_choose_noise_scale(&set->clouds[cloud], shape_set_list(set, cloud), error);
    if (!status)
        status = shape_neph_encode(set, &bytes, &size, error);
    if (!status)
        status = shape_file_write(path, bytes, size, error);
    free(bytes);
    shape_set_destroy(set);
    return status;
}

int main(int argc, char **argv)
{
    shape_error error;
    if (argc != 2) {
        fprintf(stderr, "usage: make_cloud FILE\n");
        return 2;
    }
    if (make(argv[1], &error)) {
        fprintf(stderr, "make_cloud: %s\n", error.text);
        return 1;
    }
    return 0;
}
