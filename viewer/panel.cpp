// What lies over the picture, by Dear ImGui. It changes the state and says what was wished; it does no work of its own.
#include "panel.h"

#include "setting.h"

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
    char other[VIEW_PATH_MAX] = ""; // as it is being typed
    ImVec4 covered[2] = {};         // by the panel and by the help: left, top, right, bottom
};
panel_memory memory;

constexpr float width = 310;

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

// Where the window that is being drawn stands.
ImVec4 window_box()
{
    ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    return ImVec4(low.x, low.y, low.x + size.x, low.y + size.y);
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
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("--%s: %s\nCtrl+click to type, right click to leave it to the generator", row.name,
                          row.help);
    if (!setting.given)
        return;
    ImGui::SameLine();
    ImGui::PushID(row.name);
    reset = ImGui::SmallButton("x") || reset;
    ImGui::PopID();
    if (reset)
        setting = view_setting{false, {start.number[0], start.number[1], start.number[2]}};
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
        if (choose("phase", &phase, "hg\0isotropic\0rayleigh\0mie\0two-lobe\0"))
            for (int i = 0; i < in.state->cloud_count; i++)
                if (i == cloud || memory.all_clouds)
                    in.state->clouds[i].medium.phase = static_cast<shape_phase_kind>(phase);
        turn_group("Medium", in, cloud);
    }
    if (section("Place")) {
        ImGui::Checkbox("visible", &c.visible);
        turn_group("Place", in, cloud);
    }
}

void draw_light(const view_panel_input &in)
{
    view_state &s = *in.state;
    if (!section("Sun and sky", true))
        return;
    ImGui::Checkbox("by the time of day", &s.course.day_runs);
    turn_group(s.course.day_runs ? "Day" : "Sun", in, 0);
    ImGui::DragFloat3("irradiance", s.sun_irradiance, 0.02f, 0, 100, "%.3g", ImGuiSliderFlags_AlwaysClamp);
    int sky = static_cast<int>(s.sky);
    if (choose("sky", &sky, "none\0constant\0clear\0"))
        s.sky = static_cast<shape_sky_kind>(sky);
    if (s.sky == SHAPE_SKY_CONSTANT)
        ImGui::ColorEdit3("radiance", s.sky_radiance, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
    bool air = s.air.visibility > 0;
    if (ImGui::Checkbox("air", &air))
        s.air.visibility = air ? 1000 : 0;
    if (air)
        turn_group("Air", in, 0);
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
    ImGui::Checkbox("split (X)", &s.split);
    if (s.split)
        draw_right_half(in, wish, methods);
    turn_group("Camera", in, 0);
    turn_group("Quality", in, 0);
    ImGui::InputScalarN("eye", ImGuiDataType_Double, s.eye, 3, nullptr, nullptr, "%.4g");
    ImGui::InputScalarN("target", ImGuiDataType_Double, s.target, 3, nullptr, nullptr, "%.4g");
    wish.home = ImGui::SmallButton("first view (Home)");
}

void draw_time(const view_panel_input &in, view_panel_wish &wish)
{
    if (!section("Time"))
        return;
    turn_group("Time", in, 0);
    double *wind = in.state->course.motion.wind, *drift = in.state->course.motion.drift;
    ImGui::InputScalarN("wind m/s", ImGuiDataType_Double, wind, 3, nullptr, nullptr, "%.3g");
    ImGui::InputScalarN("drift m/s", ImGuiDataType_Double, drift, 3, nullptr, nullptr, "%.3g");
    wish.play = ImGui::SmallButton(in.playing ? "stop (Space)" : "play (Space)");
}

void draw_judging(const view_panel_input &in)
{
    if (!section("Judge"))
        return;
    view_state &s = *in.state;
    ImGui::Checkbox("boxes (B)", &s.boxes);
    ImGui::SameLine();
    ImGui::Checkbox("primitives (P)", &s.outlines);
    int heat = static_cast<int>(s.heat);
    if (choose("heat (T)", &heat, "none\0steps, white at 64\0fetches, white at 128\0"))
        s.heat = static_cast<view_heat>(heat);
    ImGui::Checkbox("difference from the reference (R)", &s.difference);
    ImGui::PlotHistogram("##times", in.times, VIEW_TIMES, 0, "ms a picture", 0, FLT_MAX,
                         ImVec2(width - 30, 50));
    ImGui::Text("read %.0f, set %.0f, light %.0f, bake %.0f, draw %.0f ms", in.read_ms, in.volume_ms,
                in.light_ms, in.bake_ms, in.draw_ms);
}

void draw_files(view_panel_wish &wish)
{
    if (!section("Pictures and commands"))
        return;
    ImGui::InputInt2("size", memory.shot_size);
    for (int &side : memory.shot_size)
        side = side < 0 ? 0 : side > 16384 ? 16384 : side;
    ImGui::TextDisabled("0, 0: as the window is");
    ImGui::Checkbox("alpha, no sky", &memory.shot_alpha);
    wish.shoot = ImGui::Button("screenshot (F12)");
    wish.copy = ImGui::Button("copy the commands that make this");
}

void draw_panel(const view_panel_input &in, view_panel_wish &wish, const ImVec2 &screen)
{
    ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_Always);
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 40), ImVec2(width, screen.y - 40));
    ImGui::Begin("neph-view (Tab)", nullptr,
                 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoCollapse);
    ImGui::PushItemWidth(width - 140);
    ImGui::PushAllowKeyboardFocus(false); // Tab folds the panel, and must not enter a number on the way
    wish.undo = ImGui::SmallButton("undo");
    ImGui::SameLine();
    wish.redo = ImGui::SmallButton("redo");
    draw_generator(in);
    draw_light(in);
    draw_cloud(in);
    draw_camera(in, wish);
    draw_time(in, wish);
    draw_judging(in);
    draw_files(wish);
    ImGui::PopAllowKeyboardFocus();
    ImGui::PopItemWidth();
    memory.covered[0] = window_box();
    ImGui::End();
}

// --- what lies on the picture ---

void draw_help(const ImVec2 &screen)
{
    static const char *const rows[][2] = {
        {"drag", "turn about the cloud"},
        {"right drag", "look round"},
        {"wheel", "nearer, farther"},
        {"W S A D, E Q", "fly ahead, back, left, right, up, down; Shift: faster"},
        {"Home", "first view"},
        {"+ -", "exposure"},
        {"Tab", "panel"},
        {"X", "two methods or files, split; drag the line"},
        {"B, P", "boxes, primitives as wires"},
        {"T", "steps, then fetches a pixel as heat"},
        {"R", "difference from the reference: red brighter, blue darker"},
        {"Space", "time runs, stops"},
        {"Ctrl+Z", "undo; Ctrl+Shift+Z: redo"},
        {"Ctrl+C", "copy the commands that make what is seen"},
        {"F12", "screenshot, into this folder"},
        {"Ctrl+click", "type a slider's value; right click: reset it"},
        {"H, F1", "this help"},
        {"Esc", "quit"}};
    ImGui::SetNextWindowPos(ImVec2(screen.x / 2, screen.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::Begin("Keys and mouse", nullptr,
                 ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
    for (const auto &row : rows) {
        ImGui::TextColored(ImVec4(1, 0.85f, 0.5f, 1), "%-13s", row[0]);
        ImGui::SameLine(110);
        ImGui::TextUnformatted(row[1]);
    }
    memory.covered[1] = window_box();
    ImGui::End();
}

// A text in a box of its own, its lower left corner at `at`; returns the y above it.
float draw_note(const char *text, ImVec2 at, float most, ImU32 colour)
{
    ImDrawList *list = ImGui::GetForegroundDrawList();
    ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, most);
    ImVec2 low(at.x, at.y - size.y - 8), high(at.x + size.x + 12, at.y);
    list->AddRectFilled(low, high, IM_COL32(0, 0, 0, 170), 3);
    list->AddText(nullptr, 0, ImVec2(low.x + 6, low.y + 4), colour, text, nullptr, most);
    return low.y - 4;
}

void draw_notes(const view_panel_input &in, const ImVec2 &screen)
{
    char status[256];
    float y = screen.y - 6, most = screen.x - 24;
    if (in.open) {
        int samples = in.samples < in.state->samples ? in.samples : in.state->samples;
        std::snprintf(status, sizeof status, "%d/%d samples  %.0f ms  %zu primitives  %s", samples,
                      in.state->samples, in.draw_ms, in.primitives, in.doing);
        y = draw_note(status, ImVec2(6, y), most, IM_COL32(220, 220, 220, 255));
    }
    if (in.difference[0])
        y = draw_note(in.difference, ImVec2(6, y), most, IM_COL32(220, 200, 160, 255));
    if (in.said[0])
        y = draw_note(in.said, ImVec2(6, y), most, IM_COL32(170, 230, 170, 255));
    if (in.error[0])
        draw_note(in.error, ImVec2(6, y), most, IM_COL32(255, 140, 120, 255));
}

void draw_wires(const view_panel_input &in, const ImVec2 &screen)
{
    if (!in.placed || !(in.state->boxes || in.state->outlines))
        return;
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    view_wires wires = {};
    if (in.state->outlines)
        view_wires_primitives(&wires, in.state, in.placed, screen.x, screen.y);
    size_t primitives = wires.count;
    if (in.state->boxes)
        view_wires_boxes(&wires, in.state, in.placed, screen.x, screen.y);
    for (size_t i = 0; i < wires.count; i++) {
        const float *l = wires.lines[i];
        ImU32 colour = i < primitives ? IM_COL32(20, 60, 160, 130) : IM_COL32(255, 170, 30, 255);
        list->AddLine(ImVec2(l[0], l[1]), ImVec2(l[2], l[3]), colour);
    }
    view_wires_free(&wires);
}

// The difference, over the pixels that it was taken from; of a split picture only left of the line.
void draw_map(const view_panel_input &in, const ImVec2 &screen)
{
    int pixels[2] = {0, 0};
    glfwGetFramebufferSize(glfwGetCurrentContext(), &pixels[0], &pixels[1]);
    float part[2], border[2];
    for (int i = 0; i < 2; i++) {
        float shown = static_cast<float>(in.map_size[i] * in.map_scale);
        part[i] = shown / static_cast<float>(pixels[i]);
        border[i] = (1 - part[i]) / 2;
    }
    ImVec2 low(border[0] * screen.x, border[1] * screen.y),
        high(low.x + part[0] * screen.x, low.y + part[1] * screen.y);
    float line = in.state->split ? screen.x * in.state->divider : high.x,
          right = line < high.x ? line : high.x;
    if (right <= low.x)
        return;
    ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<intptr_t>(in.map)),
                                             low, ImVec2(right, high.y), ImVec2(0, 0),
                                             ImVec2((right - low.x) / (high.x - low.x), 1));
}

// A path's last part.
const char *bare(const char *path)
{
    const char *slash = std::strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void draw_picture(const view_panel_input &in, const ImVec2 &screen)
{
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    if (in.texture)
        list->AddImage(reinterpret_cast<ImTextureID>(static_cast<intptr_t>(in.texture)), ImVec2(0, 0), screen,
                       ImVec2(0, 1), ImVec2(1, 0));
    if (in.map)
        draw_map(in, screen);
    draw_wires(in, screen);
    if (!in.state->split)
        return;
    static const char *const methods[] = {"default", "exact", "paper", "paper-ndt"};
    const view_state &s = *in.state;
    float x = screen.x * s.divider;
    list->AddLine(ImVec2(x, 0), ImVec2(x, screen.y), IM_COL32(255, 255, 255, 200), 2);
    char names[2][160];
    const char *files[2] = {in.other[0] ? in.title : "", in.other};
    const int chosen[2] = {s.method, s.other_method};
    bool one_method = in.other[0] && s.method == s.other_method;
    for (int i = 0; i < 2; i++)
        std::snprintf(names[i], sizeof names[i], "%s%s%s", bare(files[i]),
                      in.other[0] && !one_method ? ", " : "", one_method ? "" : methods[chosen[i]]);
    list->AddText(ImVec2(x - 8 - ImGui::CalcTextSize(names[0]).x, screen.y - 60), IM_COL32_WHITE, names[0]);
    list->AddText(ImVec2(x + 8, screen.y - 60), IM_COL32_WHITE, names[1]);
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
    if (pixels == points && x > 1) // else the window system scales by itself
        ImGui::GetIO().FontGlobalScale = x;
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
    memory.covered[0] = memory.covered[1] = ImVec4(0, 0, 0, 0);
    draw_picture(*input, screen);
    if (input->open)
        draw_panel(*input, wish, screen);
    if (input->help)
        draw_help(screen);
    draw_notes(*input, screen);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    wish.shoot_size[0] = memory.shot_size[0];
    wish.shoot_size[1] = memory.shot_size[1];
    wish.shoot_alpha = memory.shot_alpha;
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
