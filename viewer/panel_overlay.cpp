// What lies on the picture, by Dear ImGui: notes, help, work under way, wires, the difference, a split picture's names.
#include "panel_overlay.hpp"

#include <GLFW/glfw3.h>

#include <cmath>
#include <cstdio>
#include <cstring>

float panel_width()
{
    return panel_plain_width * ImGui::GetIO().FontGlobalScale;
}

ImVec4 panel_window_box()
{
    ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    return ImVec4(low.x, low.y, low.x + size.x, low.y + size.y);
}

ImVec4 panel_draw_help(const ImVec2 &screen)
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
        {"B, P", "boxes; primitives as wires, then shaded"},
        {"T", "heat: steps, fetches, candidates, depth"},
        {"R", "difference from the reference: red brighter, blue darker"},
        {"Space", "time runs, stops"},
        {"Ctrl+Z, Ctrl+Y", "undo, redo (or Ctrl+Shift+Z)"},
        {"Ctrl+C", "copy the commands that make what is seen"},
        {"Ctrl+S", "save a scene, into this folder"},
        {"F12", "screenshot, into this folder"},
        {"drop a file", "open it"},
        {"Ctrl+click", "type a slider's value; right click: reset it"},
        {"H, F1", "this help"},
        {"Esc", "break off what takes long; else quit"}};
    ImGui::SetNextWindowPos(ImVec2(screen.x / 2, screen.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::Begin("Keys and mouse", nullptr,
                 ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
    for (const auto &row : rows) {
        ImGui::TextColored(ImVec4(1, 0.85f, 0.5f, 1), "%-13s", row[0]);
        ImGui::SameLine(110 * ImGui::GetIO().FontGlobalScale);
        ImGui::TextUnformatted(row[1]);
    }
    ImVec4 box = panel_window_box();
    ImGui::End();
    return box;
}

// Where what is beside the panel begins; 0 where there is no room for it.
static float panel_right(const view_panel_input &in, const ImVec2 &screen)
{
    return in.open && screen.x >= 2 * panel_width() ? panel_width() + 10 : 0;
}

ImVec4 panel_draw_work(const view_panel_input &in, view_panel_wish &wish, const ImVec2 &screen)
{
    float left = panel_right(in, screen); // not below the panel
    ImGui::SetNextWindowPos(ImVec2((left + screen.x) / 2, screen.y - 70), ImGuiCond_Always, ImVec2(0.5f, 1));
    ImGui::Begin("##work", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::TextUnformatted(in.work);
    float share = static_cast<float>(in.work_done);
    // Where the share is not known, a bar that goes round shows that the window is awake.
    if (in.work_done < 0)
        share = static_cast<float>(std::fmod(ImGui::GetTime() * 0.5, 1.0));
    ImGui::ProgressBar(share, ImVec2(160, 0), in.work_done < 0 ? "" : nullptr);
    if (in.work_ends) {
        ImGui::SameLine();
        wish.cancel = ImGui::Button("cancel (Esc)");
    }
    ImVec4 box = panel_window_box();
    ImGui::End();
    return box;
}

// A text in a box of its own, its lower left corner at `at`; returns the y above it.
static float draw_note(const char *text, ImVec2 at, float most, ImU32 colour)
{
    ImDrawList *list = ImGui::GetForegroundDrawList();
    ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, most);
    ImVec2 low(at.x, at.y - size.y - 8), high(at.x + size.x + 12, at.y);
    list->AddRectFilled(low, high, IM_COL32(0, 0, 0, 170), 3);
    list->AddText(nullptr, 0, ImVec2(low.x + 6, low.y + 4), colour, text, nullptr, most);
    return low.y - 4;
}

void panel_draw_notes(const view_panel_input &in, const ImVec2 &screen)
{
    char status[256];
    float y = screen.y - 6;
    float left = panel_right(in, screen) + 6, most = screen.x - left - 18; // so that they hide none of it
    if (in.open) {
        int samples = in.samples < in.state->samples ? in.samples : in.state->samples;
        std::snprintf(status, sizeof status, "%d/%d samples  %.0f ms  %zu primitives  %s", samples,
                      in.state->samples, in.draw_ms, in.primitives, in.doing);
        y = draw_note(status, ImVec2(6, y), screen.x - 24, IM_COL32(220, 220, 220, 255));
    }
    if (in.difference[0])
        y = draw_note(in.difference, ImVec2(left, y), most, IM_COL32(220, 200, 160, 255));
    if (in.said[0])
        y = draw_note(in.said, ImVec2(left, y), most, IM_COL32(170, 230, 170, 255));
    if (in.error[0])
        draw_note(in.error, ImVec2(left, y), most, IM_COL32(255, 140, 120, 255));
}

static void draw_solids(const view_panel_input &in, const ImVec2 &screen)
{
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    int triangles[VIEW_SOLID_TRIANGLES][3];
    int count = view_solid_triangles(triangles), corners = view_solid_corners();
    ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    view_solids solids = {};
    view_solids_make(&solids, in.state, in.placed, screen.x, screen.y);
    for (size_t i = 0; i < solids.count; i++) {
        const view_corner *c = solids.corners + i * static_cast<size_t>(corners);
        list->PrimReserve(3 * count, corners);
        unsigned first = list->_VtxCurrentIdx;
        for (int k = 0; k < count; k++)
            for (int corner : triangles[k])
                list->PrimWriteIdx(static_cast<ImDrawIdx>(first + static_cast<unsigned>(corner)));
        for (int k = 0; k < corners; k++)
            list->PrimWriteVtx(ImVec2(c[k].at[0], c[k].at[1]), white, c[k].colour);
    }
    view_solids_free(&solids);
}

static void draw_wires(const view_panel_input &in, const ImVec2 &screen)
{
    if (!in.placed || !(in.state->boxes || in.state->outlines))
        return;
    if (in.state->outlines == VIEW_OUTLINE_SHADED)
        draw_solids(in, screen);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    view_wires wires = {};
    if (in.state->outlines == VIEW_OUTLINE_WIRES)
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
static void draw_map(const view_panel_input &in, const ImVec2 &screen)
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
static const char *bare(const char *path)
{
    const char *slash = std::strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void panel_draw_picture(const view_panel_input &in, const ImVec2 &screen)
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
