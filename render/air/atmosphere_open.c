/* render/air/atmosphere_open.c: opens a model of the atmosphere by its name or folder: selects the visibilities to
 * read and makes those between them. */
#include "render/air/atmosphere_private.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

static bool folder_has(const char *folder, const char *name)
{
    char path[1024];
    return atmosphere_file(path, folder, name) == STATUS_OK && access(path, F_OK) == 0;
}

/* The tables that a visibility needs: the two about it of those that have data; beyond the last of these the last
 * two. At the visibility of a table, this alone. */
static void choose_tables(bool need[slices_max], const bool has[slices_max], const double *table_m, int count,
                          double visibility_m)
{
    int of[slices_max] = {0}, n = 0, i = 0;
    for (int k = 0; k < count; k++)
        if (has[k]) of[n++] = k;
    while (i + 2 < n && visibility_m > table_m[of[i + 1]]) i++;
    for (int k = i; k < n && k < i + 2; k++)
        if (n == 1 || visibility_m != table_m[of[k == i ? i + 1 : i]]) need[of[k]] = true;
}

/* The slices to make: of one visibility, or enough that any visibility is close to two of them. */
static Status make_slices(Atmosphere *atmosphere, const Slice *tabled, int count, double visibility_m)
{
    double step_m[slices_made_max] = {visibility_m};
    int steps = 1;
    if (isnan(visibility_m)) steps = visibility_steps(step_m, tabled, count, atmosphere->low_m, atmosphere->high_m);
    atmosphere->slice = calloc((size_t)steps, sizeof *atmosphere->slice);
    if (!atmosphere->slice) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int i = 0; i < steps && status == STATUS_OK; i++) {
        atmosphere->slices++;
        status = slice_between(&atmosphere->slice[i], atmosphere, tabled, count, step_m[i]);
    }
    return status;
}

/* Beyond the tables' visibilities haze is extrapolated along the same straight line in 1 / visibility, up to this
 * factor. */
static const double visibility_below = 0.4, visibility_above = 2.2;

/* list: visibilities and the other columns of visibilities.csv. A folder without paths_b.csv has no paths, one without
 * sky_scattered.csv no scattered light; the neighbours' count there. */
static Status open_slices(Atmosphere *atmosphere, const char *folder, const Grid *list, double visibility_m)
{
    const int count = list->nodes[0];
    const double *table_m = list->axis[0];
    bool paths[slices_max] = {false}, light[slices_max] = {false}, need[slices_max] = {false}, all[slices_max];
    bool any_paths = false, any_light = false;
    char slice_folder[slices_max][1024], name[32];
    for (int i = 0; i < count; i++) {
        snprintf(name, sizeof name, "%.0f", table_m[i]);
        if (atmosphere_file(slice_folder[i], folder, name) != STATUS_OK) return STATUS_BAD_VALUE;
        any_paths |= paths[i] = folder_has(slice_folder[i], "paths_b.csv");
        any_light |= light[i] = folder_has(slice_folder[i], "sky_scattered.csv");
        all[i] = true;
    }
    if (!any_paths) paths[0] = true; /* the missing file is reported later */
    if (!any_light) light[0] = true;
    atmosphere->low_m = table_m[0] * visibility_below;
    atmosphere->high_m = table_m[count - 1] * visibility_above;
    if (isnan(visibility_m)) {
        memcpy(need, all, sizeof need);
    } else {
        visibility_m = clamp(visibility_m, atmosphere->low_m, atmosphere->high_m);
        choose_tables(need, all, table_m, count, visibility_m);
        choose_tables(need, paths, table_m, count, visibility_m);
        choose_tables(need, light, table_m, count, visibility_m);
    }

    Slice *tabled = calloc((size_t)count, sizeof *tabled);
    if (!tabled) return STATUS_NO_MEMORY;
    int read = 0;
    Status status = STATUS_OK;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        if (!need[i]) continue;
        tabled[read].visibility_m = table_m[i];
        tabled[read].longwave_down_w_m2 = list->value[i];
        tabled[read].has_paths = paths[i];
        tabled[read].has_scattered = light[i];
        status = slice_open(&tabled[read++], atmosphere, slice_folder[i]);
    }
    if (status == STATUS_OK) status = make_slices(atmosphere, tabled, read, visibility_m);
    for (int i = 0; i < read; i++) slice_close(&tabled[i]);
    free(tabled);
    return status;
}

static Status open_model(Atmosphere *atmosphere, const char *folder, double visibility_m)
{
    static const GridColumn visibility = {"visibility_m", 100, 500000}, longwave = {"longwave_down_w_m2", 1, 1000};
    char path[1024];
    Status status = atmosphere_file(path, folder, "visibilities.csv");
    Grid list = {0};
    if (status == STATUS_OK) status = grid_open(&list, path, &visibility, 1, &longwave, 1);
    if (status != STATUS_OK) return status;
    if (list.nodes[0] > slices_max) {
        log_error("atmosphere: %s: more than %d visibilities", path, (int)slices_max);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = clear_open(atmosphere, folder);
    if (status == STATUS_OK) status = open_slices(atmosphere, folder, &list, visibility_m);
    grid_close(&list);
    return status;
}

/* ---- tables of one shape ------------------------------------------------------------------------ */

/* The first of equal shape shares its number with the others. */
static void number_shapes(Atmosphere *atmosphere)
{
    PathTable *table[(slices_made_max + 1) * AIR_BAND_COUNT + slices_made_max];
    int        count = 0;
    for (int k = 0; k < air_tabled_count; k++) table[count++] = &atmosphere->clear_path[air_tabled[k]];
    for (int s = 0; s < atmosphere->slices; s++) {
        for (int k = 0; k < air_tabled_count; k++) table[count++] = &atmosphere->slice[s].path[air_tabled[k]];
        table[count++] = &atmosphere->slice[s].scattered;
    }
    for (int i = 0; i < count; i++) {
        int first = 0;
        while (first < i && !paths_same_shape(table[first], table[i])) first++;
        table[i]->shape = first;
    }
}

Status atmosphere_open(Atmosphere **out, const char *model) { return atmosphere_open_at(out, model, NAN); }

/* Logs the available models, by their folders. */
static Status no_model(const char *model)
{
    char folder[1024], path[1400], list[512] = "";
    struct dirent **entry;
    const int count = etc_path(folder, sizeof folder, "atmosphere") ? scandir(folder, &entry, NULL, alphasort) : -1;
    for (int i = 0; i < count; i++) {
        const size_t length = strlen(list);
        snprintf(path, sizeof path, "%s/%s/visibilities.csv", folder, entry[i]->d_name);
        if (access(path, F_OK) == 0)
            snprintf(list + length, sizeof list - length, "%s%s", length ? ", " : "", entry[i]->d_name);
        free(entry[i]);
    }
    if (count >= 0) free(entry);
    log_error("atmosphere: no model %s; there are: %s (weather.atmosphere); etc/atmosphere/README.md is the format",
              model, list);
    return STATUS_BAD_VALUE;
}

Status atmosphere_open_at(Atmosphere **out, const char *model, double visibility_m)
{
    char name[96], folder[512];
    bool plain = *model && strlen(model) < 64;
    const bool named = strpbrk(model, "/."); /* a folder */
    for (const char *c = model; *c; c++)
        plain = plain && ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9') || *c == '_');
    if (!plain && !named) {
        char shown[64];
        text_escape(shown, sizeof shown, model, strlen(model));
        log_error("atmosphere: a model's name is of a-z, 0-9 and _, not '%s'; a folder has a dot or a slash: ./NAME", shown);
        return STATUS_BAD_VALUE;
    }
    if (!named) snprintf(name, sizeof name, "atmosphere/%s", model);
    if (named ? snprintf(folder, sizeof folder, "%s", model) >= (int)sizeof folder
              : !etc_path(folder, sizeof folder, name)) {
        log_error("atmosphere: path too long: model=%s", model);
        return STATUS_BAD_VALUE;
    }
    if (named && access(folder, F_OK) != 0) {
        log_error("atmosphere: there is no folder %s (weather.atmosphere); etc/atmosphere/README.md is the format", model);
        return STATUS_IO;
    }
    if (access(folder, F_OK) != 0) return no_model(model);
    Atmosphere *atmosphere = calloc(1, sizeof *atmosphere);
    if (!atmosphere) {
        log_error("atmosphere: out of memory for model %s", model);
        return STATUS_NO_MEMORY;
    }
    Status status = channels_load();
    if (status == STATUS_OK) status = sun_top_open(atmosphere->sun_top_w_m2);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        status = planck_table_create(&atmosphere->planck[k], low_m, high_m);
    }
    if (status == STATUS_OK) status = open_model(atmosphere, folder, visibility_m);
    if (status != STATUS_OK) {
        if (status == STATUS_NO_MEMORY) log_error("atmosphere: out of memory for model %s", model);
        else log_error("atmosphere: cannot use model %s: etc/atmosphere/README.md is the format", model);
        atmosphere_close(atmosphere);
        return status;
    }
    number_shapes(atmosphere);
    *out = atmosphere;
    return STATUS_OK;
}

void atmosphere_close(Atmosphere *atmosphere)
{
    if (!atmosphere) return;
    for (int i = 0; i < atmosphere->slices; i++) slice_close(&atmosphere->slice[i]);
    free(atmosphere->slice);
    for (int i = 0; i < AIR_BAND_COUNT; i++) paths_close(&atmosphere->clear_path[i]);
    for (int i = 0; i < 2; i++)
        if (atmosphere->planck[i]) planck_table_destroy(atmosphere->planck[i]);
    grid_close(&atmosphere->temperature);
    grid_close(&atmosphere->phase);
    free(atmosphere);
}
