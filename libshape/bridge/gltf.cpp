// The bridge to tinygltf: glTF and GLB 2.0 to a mesh. tinygltf parses; this file decides what may be read, walks the
// scene's nodes and puts triangles together. Everything is checked before it is used, since the file is not trusted.
#include "gltf_private.hpp"
#include "orderly_end.hpp"

#include "shape/file.h"

#include <climits>
#include <cstdlib>
#include <cstring>
#include <new>

using shape_gltf::at;
using shape_gltf::Problem;

namespace
{

enum : size_t { DEEPEST = 200, LARGEST_BUFFER = size_t(1) << 30 };

// --- files that the glTF names ---

struct Folder {
    std::string path;    // of the glTF file, "" for the current folder
    std::string refused; // why a file was not read

    // The first reason is the true one: a second try with "./" before the name follows.
    std::string refuse(const std::string &name, const char *why)
    {
        if (!refused.empty())
            return "";
        std::string shown = name.substr(0, 80);
        for (char &c : shown)
            if (static_cast<unsigned char>(c) < ' ')
                c = '?';
        refused = "names \"" + shown + "\", " + why;
        return "";
    }
};

std::string real_path(const std::string &path)
{
    char *real = realpath(path.empty() ? "." : path.c_str(), nullptr);
    std::string result = real ? real : "";
    free(real);
    return result;
}

bool is_image(const std::string &name)
{
    for (const char *suffix :
         {".png", ".jpg", ".jpeg", ".webp", ".ktx2", ".ktx", ".basis", ".dds", ".bmp", ".tga"}) {
        size_t length = std::strlen(suffix);
        if (name.size() >= length && !strcasecmp(name.c_str() + name.size() - length, suffix))
            return true;
    }
    return false;
}

// The file's path, where the name stays within the folder; "" with a reason where it does not. tinygltf has undone
// %-codes already, and puts "./" before a name on its second try.
std::string path_within(Folder &folder, const std::string &name)
{
    if (is_image(name))
        return "";
    bool scheme = name.find("://") != std::string::npos || name.compare(0, 5, "data:") == 0;
    bool absolute =
        !name.empty() && (name[0] == '/' || name[0] == '\\' || (name.size() > 1 && name[1] == ':'));
    bool upwards =
        ("/" + name + "/").find("/../") != std::string::npos || name.find("..\\") != std::string::npos;
    if (scheme || absolute || upwards || name.find('\0') != std::string::npos)
        return folder.refuse(name, "outside its own folder (put the file beside it)");
    std::string path = folder.path.empty() ? name : folder.path + "/" + name;
    std::string real = real_path(path), root = real_path(folder.path);
    if (real.empty())
        return folder.refuse(name, "which is not there (export as GLB, or copy it along)");
    if (root != "/" && real.compare(0, root.size() + 1, root + "/") != 0)
        return folder.refuse(name, "a link to outside its own folder (copy the file)");
    return real;
}

bool file_exists(const std::string &name, void *data)
{
    return !path_within(*static_cast<Folder *>(data), name).empty();
}

bool read_file(std::vector<unsigned char> *out, std::string *, const std::string &name, void *data)
{
    Folder &folder = *static_cast<Folder *>(data);
    std::string path = path_within(folder, name);
    if (path.empty())
        return false;
    unsigned char *bytes = nullptr;
    size_t size = 0;
    shape_error error;
    if (shape_file_read(path.c_str(), LARGEST_BUFFER, &bytes, &size, &error)) {
        folder.refused = std::string("names a file that cannot be read: ") + error.text;
        return false;
    }
    try {
        out->assign(bytes, bytes + size);
    } catch (...) {
        free(bytes);
        throw;
    }
    free(bytes);
    folder.refused.clear();
    return true;
}

std::string keep_path(const std::string &path, void *)
{
    return path;
}

bool skip_image(tinygltf::Image *, int, std::string *, std::string *, int, int, const unsigned char *, int,
                void *)
{
    return true;
}

// --- the container ---

uint32_t word_at(const unsigned char *c)
{
    return c[0] | uint32_t(c[1]) << 8 | uint32_t(c[2]) << 16 | uint32_t(c[3]) << 24;
}

// The JSON text of a GLB, its chunks checked: tinygltf 2.7 trusts the length of the second one by eight bytes too much.
std::string glb_text(const unsigned char *bytes, size_t size)
{
    if (size < 20)
        throw Problem("is too short for a GLB file (it is cut off)");
    if (word_at(bytes + 4) != 2)
        throw Problem("is glTF version " + std::to_string(word_at(bytes + 4)) + " (export it as 2.0)");
    size_t length = word_at(bytes + 8), json = word_at(bytes + 12);
    if (length > size)
        throw Problem("says it has " + std::to_string(length) + " bytes, but has " + std::to_string(size) +
                      " (it is cut off)");
    if (length < 20 || word_at(bytes + 16) != 0x4E4F534A || json > length - 20)
        throw Problem("has no whole JSON chunk (it is damaged)");
    size_t at_bin = 20 + json;
    if (length - at_bin >= 8 && word_at(bytes + at_bin) > length - at_bin - 8)
        throw Problem("has a binary chunk that reaches beyond its end (it is cut off)");
    return std::string(reinterpret_cast<const char *>(bytes + 20), json);
}

// tinygltf and its JSON library recurse as deep as brackets nest.
void check_depth(const char *text, size_t size)
{
    size_t depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < size; i++) {
        char c = text[i];
        if (quoted) {
            i += c == '\\';
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if ((c == '{' || c == '[') && ++depth > DEEPEST) {
            throw Problem("nests its JSON deeper than 200 levels");
        } else if ((c == '}' || c == ']') && depth) {
            depth--;
        }
    }
}

std::string first_line(const std::string &text)
{
    std::string line = text.substr(0, text.find('\n')).substr(0, 200);
    for (char &c : line)
        if (static_cast<unsigned char>(c) < ' ')
            c = '?';
    return line.empty() ? "cannot be parsed" : line;
}

const char *compression_in(const std::string &json)
{
    for (const char *name :
         {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (json.find(name) != std::string::npos)
            return name;
    return nullptr;
}

// tinygltf 2.7 misses a skin's bind matrices aloud, and reads on; glTF 2.0 (section 5.28) lets them be left out.
void drop_needless(std::string &problem)
{
    static const std::string needless = "'inverseBindMatrices' property is missing in Skin.\n";
    for (size_t found; (found = problem.find(needless)) != std::string::npos;)
        problem.erase(found, needless.size());
}

void load(tinygltf::Model &model, Folder &folder, const unsigned char *bytes, size_t size)
{
    if (size > UINT_MAX)
        throw Problem("is larger than 4 GiB");
    bool binary = size >= 4 && !std::memcmp(bytes, "glTF", 4);
    std::string json =
        binary ? glb_text(bytes, size) : std::string(reinterpret_cast<const char *>(bytes), size);
    check_depth(json.data(), json.size());
    tinygltf::TinyGLTF loader;
    tinygltf::FsCallbacks files = {file_exists, keep_path, read_file, nullptr, &folder};
    loader.SetFsCallbacks(files);
    loader.SetImageLoader(skip_image, nullptr);
    std::string problem, warning;
    bool good = binary
                    ? loader.LoadBinaryFromMemory(&model, &problem, &warning, bytes, unsigned(size), "")
                    : loader.LoadASCIIFromString(&model, &problem, &warning, json.data(), unsigned(size), "");
    if (good)
        drop_needless(problem);
    if (good && problem.empty())
        return;
    if (first_line(problem) == "std::bad_alloc") // what its JSON library threw, as a text
        throw std::bad_alloc();
    const char *compression = compression_in(json);
    if (compression)
        throw Problem("is compressed by " + std::string(compression) + " (export it without compression)");
    if (!folder.refused.empty())
        throw Problem(folder.refused);
    throw Problem("is not a glTF file that can be read: " + first_line(problem));
}

void check_extensions(const tinygltf::Model &model)
{
    static const char *const known[] = {"KHR_mesh_quantization", "KHR_texture_transform",
                                        "KHR_lights_punctual", "KHR_texture_basisu", "EXT_texture_webp"};
    for (const std::string &name : model.extensionsRequired) {
        bool good = name.compare(0, 14, "KHR_materials_") == 0;
        for (const char *other : known)
            good = good || name == other;
        bool packed = name.find("compression") != std::string::npos;
        if (!good)
            throw Problem(
                "needs the extension " + name.substr(0, 60) +
                (packed ? " (export it without compression)" : ", which is not known (export it without)"));
    }
}

// --- the scene ---

struct Reader {
    const tinygltf::Model &model;
    std::vector<shape_frame> world;     // a frame a node
    std::vector<unsigned char> visited; // a file's nodes may not run in circles or be shared
    std::vector<int> order;             // the scene's nodes, parents first
    std::vector<shape_dvec3> points;
    std::vector<uint32_t> indices;
    shape_mesh_counts counts = {};

    explicit Reader(const tinygltf::Model &m)
        : model(m), world(m.nodes.size(), shape_frame_identity()), visited(m.nodes.size(), 0)
    {
    }

    void place_nodes()
    {
        for (int root : roots())
            place(root, shape_frame_identity());
        for (size_t i = 0; i < order.size(); i++) {
            shape_frame parent = world[size_t(order[i])];
            for (int child : model.nodes[size_t(order[i])].children)
                place(child, parent);
        }
    }

    // Only the default scene's nodes; where there is no scene, every node that is nobody's child.
    std::vector<int> roots() const
    {
        if (!model.scenes.empty())
            return at(model.scenes, model.defaultScene < 0 ? 0 : model.defaultScene, "scene").nodes;
        std::vector<unsigned char> is_child(model.nodes.size(), 0);
        for (const tinygltf::Node &node : model.nodes)
            for (int child : node.children)
                if (child >= 0 && size_t(child) < is_child.size())
                    is_child[size_t(child)] = 1;
        std::vector<int> result;
        for (size_t i = 0; i < is_child.size(); i++)
            if (!is_child[i])
                result.push_back(int(i));
        return result;
    }

    void place(int index, const shape_frame &parent)
    {
        shape_frame own = shape_gltf::node_frame(at(model.nodes, index, "node"));
        if (visited[size_t(index)]++)
            throw Problem("has a node with two parents, or nodes that run in a circle");
        world[size_t(index)] = shape_frame_multiply(&parent, &own);
        order.push_back(index);
    }

    void add_node(int index)
    {
        const tinygltf::Node &node = model.nodes[size_t(index)];
        if (node.mesh < 0)
            return;
        if (node.extensions.count("EXT_mesh_gpu_instancing"))
            throw Problem("uses EXT_mesh_gpu_instancing (export instances as nodes)");
        counts.instances++;
        for (const tinygltf::Primitive &primitive : at(model.meshes, node.mesh, "mesh").primitives)
            add_primitive(primitive, node, world[size_t(index)]);
    }

    void add_primitive(const tinygltf::Primitive &primitive, const tinygltf::Node &node,
                       const shape_frame &frame)
    {
        int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
        if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
            counts.skipped++;
            return;
        }
        auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) {
            counts.skipped++;
            return;
        }
        check_compression(primitive);
        size_t first = points.size();
        std::vector<shape_dvec3> own = read_points(position->second);
        if (node.skin >= 0) {
            shape_gltf::apply_skin(model, primitive, at(model.skins, node.skin, "skin"), world, own);
            counts.skinned = true;
        } else {
            for (shape_dvec3 &p : own)
                p = shape_frame_point(&frame, p);
        }
        if (first + own.size() > SHAPE_MESH_MAX_POINTS)
            throw Problem("has more than " + std::to_string(SHAPE_MESH_MAX_POINTS) +
                          " vertices in all its instances");
        points.insert(points.end(), own.begin(), own.end());
        bool mirrored = node.skin < 0 && shape_frame_determinant(&frame) < 0;
        add_triangles(corners(primitive, own.size()), mode, first, own.size(), mirrored);
    }

    void check_compression(const tinygltf::Primitive &primitive) const
    {
        if (!primitive.extensions.count("KHR_draco_mesh_compression"))
            return;
        auto position = primitive.attributes.find("POSITION");
        if (at(model.accessors, position->second, "accessor").bufferView < 0)
            throw Problem("is compressed by KHR_draco_mesh_compression (export it without compression)");
    }

    std::vector<shape_dvec3> read_points(int accessor) const
    {
        std::vector<double> values = shape_gltf::read_accessor(model, accessor, 3, "positions");
        std::vector<shape_dvec3> result(values.size() / 3);
        for (size_t i = 0; i < result.size(); i++)
            result[i] = shape_dvec3_make(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
        return result;
    }

    std::vector<uint32_t> corners(const tinygltf::Primitive &primitive, size_t count) const
    {
        if (primitive.indices >= 0)
            return shape_gltf::read_indices(model, primitive.indices);
        std::vector<uint32_t> result(count);
        for (size_t i = 0; i < count; i++)
            result[i] = uint32_t(i);
        return result;
    }

    // glTF 2.0 section 3.7.2.1: lists, strips (every second triangle turned) and fans.
    void add_triangles(const std::vector<uint32_t> &corner, int mode, size_t first, size_t count,
                       bool mirrored)
    {
        for (uint32_t index : corner)
            if (index >= count)
                throw Problem("names vertex " + std::to_string(index) + " of " + std::to_string(count));
        size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
        for (size_t i = 0; i + 2 < corner.size(); i += step) {
            uint32_t a = corner[i], b = corner[i + 1], c = corner[i + 2];
            if (mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2)
                std::swap(b, c);
            if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
                a = corner[0];
            if (mirrored)
                std::swap(b, c);
            if (indices.size() >= 3 * size_t(SHAPE_MESH_MAX_TRIANGLES))
                throw Problem("has more than " + std::to_string(SHAPE_MESH_MAX_TRIANGLES) +
                              " triangles in all its instances");
            for (uint32_t index : {a, b, c})
                indices.push_back(uint32_t(first) + index);
        }
    }

    void check_points() const
    {
        for (const shape_dvec3 &p : points) {
            double largest = fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
                throw Problem("has a vertex with a coordinate that is not a finite number (repair the mesh)");
            if (largest > SHAPE_MESH_MAX_COORDINATE)
                throw Problem("has a vertex with a coordinate beyond 1e12");
        }
    }
};

shape_mesh *read(const char *folder_path, const unsigned char *bytes, size_t size, shape_error *error)
{
    Folder folder = {folder_path, ""};
    tinygltf::Model model;
    load(model, folder, bytes, size);
    check_extensions(model);
    Reader reader(model);
    reader.place_nodes();
    for (int index : reader.order)
        reader.add_node(index);
    reader.check_points();
    if (reader.indices.empty())
        throw Problem("has no triangles in its scene (export the object as a mesh, with its faces)");
    size_t triangles = reader.indices.size() / 3;
    shape_mesh *mesh = shape_mesh_create(reader.points.size(), triangles, error);
    if (!mesh)
        return nullptr;
    std::memcpy(mesh->points, reader.points.data(), reader.points.size() * sizeof(shape_dvec3));
    std::memcpy(mesh->indices, reader.indices.data(), reader.indices.size() * sizeof(uint32_t));
    mesh->point_count = reader.points.size();
    mesh->triangle_count = triangles;
    mesh->counts = reader.counts;
    mesh->counts.faces = mesh->counts.triangles = triangles;
    mesh->counts.animated = !model.animations.empty();
    return mesh;
}

} // namespace

extern "C" shape_status shape_gltf_decode(const char *name, const char *folder, const void *bytes,
                                          size_t size, shape_mesh **mesh, shape_error *error)
{
    const OrderlyEnd guard("to read glTF (make the mesh smaller)");
    try {
        if (!size)
            return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the file is empty", name);
        shape_mesh *made = read(folder, static_cast<const unsigned char *>(bytes), size, error);
        if (!made)
            return SHAPE_ERROR_MEMORY;
        *mesh = made;
        return SHAPE_OK;
    } catch (const Problem &problem) {
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the file %s", name, problem.what());
    } catch (const std::bad_alloc &) {
        return shape_error_memory(error);
    } catch (const std::exception &problem) {
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the file is damaged: %s", name,
                               first_line(problem.what()).c_str());
    } catch (...) {
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the file is damaged", name);
    }
}
