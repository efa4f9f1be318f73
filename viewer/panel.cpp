// The panel, by Dear ImGui; what lies on the picture is in panel_overlay.cpp. It changes the state and says what was wished; it does no work of its own.
#include "panel.h"

#include "panel_overlay.hpp"
#include "setting.h"
#include "shape_gl.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cmath>
#include <cstdio>
#include <cstring>

namespace
{

// What the panel itself remembers: which cloud its sliders turn, and the size of screenshots.
struct panel_memory {
    int cloud = 0;
    bool all_clouds = true;
    int shot_size[2] = {0, 0}; // 0: as the window is
    bool shot_alpha = false;
    bool shot_exr = false;
    char other[VIEW_PATH_MAX] = "", file[VIEW_PATH_MAX] = ""; // as they are being typed
    ImVec4 covered[3] = {}; // by the panel, the help, the work under way: left, top, right, bottom
};
panel_memory memory;

// --- one value ---

void format_of(const view_knob &knob, char *format, size_t room)
{
    const char *number = knob.kind == VIEW_KNOB_INT ? "%d" : "%.4g";
    std::snprintf(format, room, "%s%s%s", number, knob.unit[0] ? " " : "", knob.unit);
}

void explain(const view_knob &knob)
{
    if (!ImGui::IsItemHovered())
        return;
    ImGui::SetTooltip("%s%s%.4g to %.4g %s\nCtrl+click to type, right click to reset", knob.help,
                      knob.help[0] ? "\n" : "", knob.min, knob.max, knob.unit);
}

// Whether a knob's value was changed; the slider keeps to the range, also for typed values.
bool slide(const view_knob &knob, void *value)
{
    char format[32];
    format_of(knob, format, sizeof format);
    ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp;
    if (knob.logarithmic)
        flags |= ImGuiSliderFlags_Logarithmic;
    if (knob.kind == VIEW_KNOB_INT) {
        int low = static_cast<int>(knob.min), high = static_cast<int>(knob.max);
        return ImGui::SliderScalar(knob.name, ImGuiDataType_S32, value, &low, &high, format, flags);
    }
    if (knob.kind == VIEW_KNOB_FLOAT) {
        float low = static_cast<float>(knob.min), high = static_cast<float>(knob.max);
        return ImGui::SliderScalar(knob.name, ImGuiDataType_Float, value, &low, &high, format, flags);
    }
    return ImGui::SliderScalar(knob.name, ImGuiDataType_Double, value, &knob.min, &knob.max, format, flags);
}

void turn_knob(const view_knob &knob, const view_panel_input &in, int cloud)
{
    bool of_cloud = knob.of != VIEW_OF_STATE;
    bool changed = slide(knob, view_knob_value(&knob, in.state, cloud));
    bool reset = ImGui::IsItemClicked(ImGuiMouseButton_Right);
    explain(knob);
    bool known = !of_cloud || cloud < in.base->cloud_count;
    double start = known ? view_knob_get(&knob, in.base, cloud) : 0;
    if (known && view_knob_get(&knob, in.state, cloud) != start) {
        ImGui::SameLine();
        ImGui::PushID(knob.name);
        reset = ImGui::SmallButton("x") || reset;
        ImGui::PopID();
        if (reset) {
            view_knob_set(&knob, in.state, cloud, start);
            changed = true;
        }
    }
    if (!changed || !of_cloud || knob.of == VIEW_OF_CLOUD || !memory.all_clouds)
        return;
    for (int i = 0; i < in.state->cloud_count; i++)
        view_knob_set(&knob, in.state, i, view_knob_get(&knob, in.state, cloud));
}

void turn_group(const char *group, const view_panel_input &in, int cloud)
{
    for (size_t i = 0; i < view_knob_count; i++)
        if (!std::strcmp(view_knobs[i].group, group))
            turn_knob(view_knobs[i], in, cloud);
}

bool choose(const char *name, int *value, const char *words)
{
    return ImGui::Combo(name, value, words);
}

// A value that is no knob: what it is and its range, and a small x that puts it back to the file's.
void explain_value(const char *text, void *value, const void *start, size_t size)
{
    bool reset = ImGui::IsItemClicked(ImGuiMouseButton_Right);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("%s\nCtrl+click to type, right click to reset", text);
    if (!std::memcmp(value, start, size))
        return;
    ImGui::SameLine();
    ImGui::PushID(value);
    reset = ImGui::SmallButton("x") || reset;
    ImGui::PopID();
    if (reset)
        std::memcpy(value, start, size);
}

// Three numbers with a unit.
void turn_vector(const char *name, const char *text, double value[3], const double start[3], double low,
                 double limit)
{
    float speed = static_cast<float>(limit * 1e-4);
    ImGui::DragScalarN(name, ImGuiDataType_Double, value, 3, speed, &low, &limit, "%.3g",
                       ImGuiSliderFlags_AlwaysClamp);
    explain_value(text, value, start, 3 * sizeof *value);
}

bool section(const char *name, bool open = false)
{
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

// --- sections ---

// One option's widget; whether it was changed. Drags go by a hundredth of the value a pixel.
bool turn_setting(const view_setting_row &row, view_setting &setting)
{
    double *n = setting.number;
    if (row.kind == VIEW_SETTING_FLAG) {
        bool on = n[0] != 0;
        bool changed = ImGui::Checkbox(row.name, &on);
        n[0] = on;
        return changed;
    }
    if (row.kind == VIEW_SETTING_CHOICE) {
        char words[256];
        int length = std::snprintf(words, sizeof words - 1, "%s", row.choices),
            chosen = static_cast<int>(n[0]);
        for (int i = 0; i < length; i++)
            words[i] = words[i] == '|' ? '\0' : words[i];
        words[length + 1] = '\0';
        bool changed = ImGui::Combo(row.name, &chosen, words);
        n[0] = chosen;
        return changed;
    }
    double largest = 0;
    for (int i = 0; i < row.count; i++)
        largest = largest < n[i] ? n[i] : largest < -n[i] ? -n[i] : largest;
    bool whole = row.kind == VIEW_SETTING_INTEGER, bounded = row.min != 0 || row.max != 0;
    float speed = static_cast<float>(whole ? 0.1 + largest * 0.01 : (largest > 0 ? largest : 1) * 0.01);
    double before[3] = {n[0], n[1], n[2]};
    ImGui::DragScalarN(row.name, ImGuiDataType_Double, n, row.count, speed, bounded ? &row.min : nullptr,
                       bounded ? &row.max : nullptr, whole ? "%.0f" : "%.4g", ImGuiSliderFlags_AlwaysClamp);
    for (int i = 0; i < row.count && whole; i++)
        n[i] = std::floor(n[i] + 0.5);
    if (row.range && n[0] > n[1])
        n[n[0] != before[0] ? 0 : 1] = n[n[0] != before[0] ? 1 : 0];
    return n[0] != before[0] || n[1] != before[1] || n[2] != before[2];
}

// What is not given is the generator's own choice, and grey.
void draw_setting(const view_panel_input &in, const view_setting_row &row, int i)
{
    view_setting &setting = in.state->generator.settings[i];
    const view_setting &start = in.base->generator.settings[i];
    if (!setting.given)
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    bool was = setting.given;
    if (turn_setting(row, setting))
        setting.given = true;
    bool reset = ImGui::IsItemClicked(ImGuiMouseButton_Right);
    if (!was)
        ImGui::PopStyleColor();
    const bool scene = in.base->generator.entry > 0; // there the file may give some
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("--%s: %s\nCtrl+click to type, right click to %s", row.name, row.help,
                          scene ? "reset" : "leave it to the generator");
    if (scene
            ? setting.given == start.given && !std::memcmp(setting.number, start.number, sizeof start.number)
            : !setting.given)
        return;
    ImGui::SameLine();
    ImGui::PushID(row.name);
    reset = ImGui::SmallButton("x") || reset;
    ImGui::PopID();
    if (reset)
        setting = view_setting{scene && start.given, {start.number[0], start.number[1], start.number[2]}};
}

void draw_generator(const view_panel_input &in)
{
    view_generator &g = in.state->generator;
    const char *program = view_generator_program(&g);
    view_setting_row row;
    if (g.which < 0 || !section(program, true))
        return;
    if (!in.watched)
        ImGui::TextDisabled("not made again: standard input, or a morph");
    if (g.entry)
        ImGui::TextDisabled("makes cloud entry %d of the scene", g.entry);
    for (int i = 0; view_setting_get_row(&g, i, &row); i++)
        draw_setting(in, row, i);
    static const uint64_t one = 1;
    ImGui::InputScalar("seed", ImGuiDataType_U64, &g.seed, &one);
}

int choose_cloud(const view_panel_input &in)
{
    int count = in.state->cloud_count;
    if (memory.cloud >= count)
        memory.cloud = 0;
    if (count < 2)
        return 0;
    if (ImGui::BeginCombo("cloud", in.state->clouds[memory.cloud].name)) {
        for (int i = 0; i < count; i++) {
            ImGui::PushID(i);
            if (ImGui::Selectable(in.state->clouds[i].name, i == memory.cloud))
                memory.cloud = i;
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    ImGui::Checkbox("field and medium of all clouds alike", &memory.all_clouds);
    if (in.all_clouds > static_cast<size_t>(count))
        ImGui::TextDisabled("%d of %zu clouds can be changed", count, in.all_clouds);
    return memory.cloud;
}

void draw_cloud(const view_panel_input &in)
{
    if (!in.state->cloud_count)
        return;
    int cloud = choose_cloud(in);
    view_cloud &c = in.state->clouds[cloud];
    if (section("Field", true))
        turn_group("Field", in, cloud);
    if (section("Medium", true)) {
        int phase = static_cast<int>(c.medium.phase);
        const int was = phase;
        choose("phase", &phase, "hg\0isotropic\0rayleigh\0mie\0two-lobe\0");
        int start =
            cloud < in.base->cloud_count ? static_cast<int>(in.base->clouds[cloud].medium.phase) : phase;
        explain_value("phase function", &phase, &start, sizeof phase);
        if (phase != was)
            for (int i = 0; i < in.state->cloud_count; i++)
                if (i == cloud || memory.all_clouds)
                    in.state->clouds[i].medium.phase = static_cast<shape_phase_kind>(phase);
        turn_group("Medium", in, cloud);
    }
    if (section("Place")) {
        ImGui::Checkbox("visible", &c.visible);
        if (cloud < in.base->cloud_count)
            explain_value("whether the cloud is there", &c.visible, &in.base->clouds[cloud].visible,
                          sizeof c.visible);
        turn_group("Place", in, cloud);
    }
}

void draw_light(const view_panel_input &in)
{
    view_state &s = *in.state;
    if (!section("Sun and sky", true))
        return;
    const view_state &start = *in.base;
    ImGui::Checkbox("by the time of day", &s.course.day_runs);
    explain_value("the sun goes by hour, latitude and declination", &s.course.day_runs,
                  &start.course.day_runs, sizeof s.course.day_runs);
    turn_group(s.course.day_runs ? "Day" : "Sun", in, 0);
    ImGui::DragFloat3("irradiance", s.sun_irradiance, 0.02f, 0, 100, "%.3g", ImGuiSliderFlags_AlwaysClamp);
    explain_value("of the sun, on a plane that faces it:\nred, green, blue, 0 to 100 (pi: white is 1)",
                  s.sun_irradiance, start.sun_irradiance, sizeof s.sun_irradiance);
    int sky = static_cast<int>(s.sky);
    const int sky_start = static_cast<int>(start.sky);
    choose("sky", &sky, "none\0constant\0clear\0");
    explain_value("none, one radiance, or a clear sky", &sky, &sky_start, sizeof sky);
    s.sky = static_cast<shape_sky_kind>(sky);
    if (s.sky == SHAPE_SKY_CONSTANT) {
        ImGui::ColorEdit3("radiance", s.sky_radiance, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
        explain_value("of the sky: red, green, blue", s.sky_radiance, start.sky_radiance,
                      sizeof s.sky_radiance);
    }
    bool air = s.air.visibility > 0;
    const bool air_start = start.air.visibility > 0;
    const bool air_turned = ImGui::Checkbox("air", &air);
    explain_value("between the clouds: far things fade into the sky, and shadows are seen as shafts", &air,
                  &air_start, sizeof air);
    if (air_turned || air != (s.air.visibility > 0))
        s.air.visibility = air ? (air_start ? start.air.visibility : 1000) : 0;
    if (air)
        turn_group("Air", in, 0);
}

// What is made of sun and sky in a cloud; docs/light.md has the laws.
void draw_lighting(const view_panel_input &in)
{
    if (!section("Light in clouds"))
        return;
    view_lighting &l = in.state->lighting;
    const view_lighting &start = in.base->lighting;
    if (in.state->method >= SHAPE_GL_PAPER)
        ImGui::TextDisabled("the methods of 2018 have their own");
    choose("light", &l.law, "grid\0single\0powder\0powder-angle\0beer-max\0octaves\0");
    explain_value("grid: all scatterings of sun and sky. The others are laws of the depth to the sun alone;\n"
                  "the reference has none of them, nor what stands below",
                  &l.law, &start.law, sizeof l.law);
    for (size_t i = 0; i < view_knob_count; i++) {
        const bool octaves = !std::strcmp(view_knobs[i].name, "light octaves");
        const bool powder = l.law == SHAPE_GL_LAW_POWDER || l.law == SHAPE_GL_LAW_POWDER_ANGLE;
        if (!std::strcmp(view_knobs[i].group, "Light") && (octaves ? l.law == SHAPE_GL_LAW_OCTAVES : powder))
            turn_knob(view_knobs[i], in, 0);
    }
    turn_vector("ambient",
                "radiance that reaches every point alike from all round:\nred, green, blue, 0 to 10",
                l.ambient, start.ambient, 0, 10);
    turn_vector("emission, 1/m", "of density 1, radiance a metre:\nred, green, blue, 0 to 10", l.emission,
                start.emission, 0, 10);
}

// Of a split picture: by which method, and of which file.
void draw_right_half(const view_panel_input &in, view_panel_wish &wish, const char *methods)
{
    choose("right half", &in.state->other_method, methods);
    bool entered = ImGui::InputTextWithHint("right file", "the same", memory.other, sizeof memory.other,
                                            ImGuiInputTextFlags_EnterReturnsTrue);
    if (!ImGui::IsItemActive() && !entered)
        std::snprintf(memory.other, sizeof memory.other, "%s", in.other);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("a .neph or a grammar, then Enter; empty: the same file by another method");
    if (!entered)
        return;
    wish.open_other = true;
    std::snprintf(wish.other, sizeof wish.other, "%s", memory.other);
}

void draw_camera(const view_panel_input &in, view_panel_wish &wish)
{
    if (!section("Camera and method", true))
        return;
    view_state &s = *in.state;
    static const char methods[] = "default\0exact\0paper\0paper-ndt\0";
    choose("method", &s.method, methods);
    explain_value("how the picture is drawn; the last two for comparison only", &s.method, &in.base->method,
                  sizeof s.method);
    ImGui::Checkbox("split (X)", &s.split);
    if (s.split)
        draw_right_half(in, wish, methods);
    turn_group("Camera", in, 0);
    turn_group("Quality", in, 0);
    ImGui::InputScalarN("eye, m", ImGuiDataType_Double, s.eye, 3, nullptr, nullptr, "%.4g");
    ImGui::InputScalarN("target, m", ImGuiDataType_Double, s.target, 3, nullptr, nullptr, "%.4g");
    wish.home = ImGui::SmallButton("first view (Home)");
}

void draw_time(const view_panel_input &in, view_panel_wish &wish)
{
    if (!section("Time"))
        return;
    turn_group("Time", in, 0);
    double *wind = in.state->course.motion.wind, *drift = in.state->course.motion.drift;
    const shape_motion &start = in.base->course.motion;
    turn_vector("wind, m/s",
                "carries the clouds with their noise:\nx (east), y (up), z (south), -1000 to 1000", wind,
                start.wind, -1000, 1000);
    turn_vector("drift, m/s", "moves the noise through the clouds:\nx, y, z, -1000 to 1000", drift,
                start.drift, -1000, 1000);
    wish.play = ImGui::SmallButton(in.playing ? "stop (Space)" : "play (Space)");
}

// The passes of the last pictures, one on the other.
void draw_times(const view_panel_input &in)
{
    static const char *const names[VIEW_PASSES] = {"set", "light", "bake", "draw"};
    static const ImU32 colours[VIEW_PASSES] = {IM_COL32(190, 120, 220, 255), IM_COL32(250, 190, 70, 255),
                                               IM_COL32(90, 200, 150, 255), IM_COL32(90, 150, 250, 255)};
    const float wide = panel_width() - 30, high = 60;
    ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList *list = ImGui::GetWindowDrawList();
    float most = 1;
    for (int i = 0; i < VIEW_TIMES; i++) {
        float sum = 0;
        for (int pass = 0; pass < VIEW_PASSES; pass++)
            sum += in.times[pass][i];
        most = sum > most ? sum : most;
    }
    list->AddRectFilled(at, ImVec2(at.x + wide, at.y + high), IM_COL32(30, 34, 42, 255));
    for (int i = 0; i < VIEW_TIMES; i++) {
        float x = at.x + wide * static_cast<float>(i) / VIEW_TIMES, y = at.y + high;
        for (int pass = 0; pass < VIEW_PASSES; pass++) {
            float top = y - high * in.times[pass][i] / most;
            if (top < y)
                list->AddRectFilled(ImVec2(x, top), ImVec2(x + wide / VIEW_TIMES, y), colours[pass]);
            y = top;
        }
    }
    char text[32];
    std::snprintf(text, sizeof text, "%.0f ms", static_cast<double>(most));
    list->AddText(ImVec2(at.x + 4, at.y + 2), IM_COL32_WHITE, text);
    ImGui::Dummy(ImVec2(wide, high));
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("milliseconds of each of the last %d pictures, by pass", VIEW_TIMES);
    const double ms[VIEW_PASSES] = {in.volume_ms, in.light_ms, in.bake_ms, in.draw_ms};
    for (int pass = 0; pass < VIEW_PASSES; pass++) {
        if (pass)
            ImGui::SameLine();
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colours[pass]), "%s %.0f", names[pass], ms[pass]);
    }
    ImGui::TextDisabled("file read in %.0f ms; window: at most %.0f ms", in.read_ms, in.longest_ms);
}

void draw_judging(const view_panel_input &in)
{
    if (!section("Judge"))
        return;
    view_state &s = *in.state;
    ImGui::Checkbox("boxes (B)", &s.boxes);
    choose("primitives (P)", &s.outlines, "none\0as wires\0shaded\0");
    choose("heat (T)", &s.heat,
           "none\0steps, white at 64\0fetches, white at 128\0candidates, white at 32\0optical depth, white "
           "at 5\0");
    if (s.heat == VIEW_HEAT_CANDIDATES && s.method == 0)
        ImGui::TextDisabled("the default method looks at voxels: none");
    ImGui::Checkbox("difference from the reference (R)", &s.difference);
    draw_times(in);
    if (in.chosen[0])
        ImGui::TextWrapped("--error chose: %s", in.chosen);
}

void draw_files(view_panel_wish &wish)
{
    if (!section("Scenes and pictures"))
        return;
    ImGui::InputTextWithHint("file", "a new name", memory.file, sizeof memory.file);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("a scene to save, or what is to be opened: a scene, a .neph, a grammar, a mesh,\n"
                          "a picture that was written here; one can be dropped on the window, too");
    wish.save = ImGui::Button("save scene (Ctrl+S)");
    ImGui::SameLine();
    wish.open_file = ImGui::Button("open") && memory.file[0];
    std::snprintf(wish.file, sizeof wish.file, "%s", memory.file);
    ImGui::InputInt2("size, pixels", memory.shot_size);
    for (int &side : memory.shot_size)
        side = side < 0 ? 0 : side > 16384 ? 16384 : side;
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("of screenshots, to 16384; 0, 0: as the window is");
    ImGui::Checkbox("alpha, no sky", &memory.shot_alpha);
    ImGui::SameLine();
    ImGui::Checkbox("EXR", &memory.shot_exr);
    wish.shoot = ImGui::Button("screenshot (F12)");
    wish.copy = ImGui::Button("copy the commands that make this");
}

void draw_panel(const view_panel_input &in, view_panel_wish &wish, const ImVec2 &screen)
{
    const float width = panel_width();
    ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_Always);
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 40),
                                        ImVec2(width, screen.y - 40 * ImGui::GetIO().FontGlobalScale));
    ImGui::Begin("neph-view (Tab)", nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoCollapse);
    ImGui::PushItemWidth(width * 170 / panel_plain_width);
    ImGui::PushAllowKeyboardFocus(false); // Tab folds the panel, and must not enter a number on the way
    wish.undo = ImGui::SmallButton("undo");
    ImGui::SameLine();
    wish.redo = ImGui::SmallButton("redo");
    draw_generator(in);
    draw_light(in);
    draw_cloud(in);
    draw_lighting(in);
    draw_camera(in, wish);
    draw_time(in, wish);
    draw_judging(in);
    draw_files(wish);
    ImGui::PopAllowKeyboardFocus();
    ImGui::PopItemWidth();
    memory.covered[0] = panel_window_box();
    ImGui::End();
}

} // namespace

extern "C" {

void view_panel_start(GLFWwindow *window)
{
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // no file is left behind
    ImGui::StyleColorsDark();
    ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.8f;
    float x = 1, y = 1;
    glfwGetWindowContentScale(window, &x, &y);
    int pixels = 0, points = 0;
    glfwGetFramebufferSize(window, &pixels, nullptr);
    glfwGetWindowSize(window, &points, nullptr);
    if (pixels == points && x > 1) { // else the window system scales by itself
        ImGui::GetIO().FontGlobalScale = x;
        ImGui::GetStyle().ScaleAllSizes(x);
    }
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

void view_panel_stop(void)
{
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

view_panel_wish view_panel_draw(const view_panel_input *input)
{
    view_panel_wish wish = {};
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    ImVec2 screen = ImGui::GetIO().DisplaySize;
    for (ImVec4 &box : memory.covered)
        box = ImVec4(0, 0, 0, 0);
    panel_draw_picture(*input, screen);
    if (input->open)
        draw_panel(*input, wish, screen);
    if (input->help)
        memory.covered[1] = panel_draw_help(screen);
    if (input->work)
        memory.covered[2] = panel_draw_work(*input, wish, screen);
    panel_draw_notes(*input, screen);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    wish.shoot_size[0] = memory.shot_size[0];
    wish.shoot_size[1] = memory.shot_size[1];
    wish.shoot_alpha = memory.shot_alpha;
    wish.shoot_exr = memory.shot_exr;
    return wish;
}

bool view_panel_covers(double x, double y)
{
    if (ImGui::IsAnyItemActive() || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup))
        return ImGui::GetIO().WantCaptureMouse;
    // ImGui's own answer is that of the last frame's mouse, which may have been elsewhere.
    for (const ImVec4 &box : memory.covered)
        if (x >= static_cast<double>(box.x) && y >= static_cast<double>(box.y) &&
            x < static_cast<double>(box.z) && y < static_cast<double>(box.w))
            return true;
    return false;
}

bool view_panel_has_keys(void)
{
    return ImGui::GetIO().WantTextInput;
}

bool view_panel_is_busy(void)
{
    return ImGui::IsAnyItemActive();
}
}
