/* sensor/commands/exercise_places.c: where the entities of a scenario hide, as a table; and the settings of a node that
 * has their ground. */
#include "sensor/commands/exercise_places_private.h"

#include "pitviper_output.h"
#include "sensor/commands/overwrite.h"

#include <errno.h>

static void write_rows(FILE *file, const Cast *cast)
{
    const Scenario *s = cast->scenario;
    fputs("# Where entities hide: written by pitviper exercise. planned, judged: share hidden from the observer of\n"
          "# seen.*, as the scenario has it and by rays against the plants\n"
          "entity,marking,type,hide,net,planned,judged,candidates,x_m,y_m,heading_deg\n",
          file);
    for (int n = 0; n < cast->hidden_count; n++) {
        const CastHidden    *own = &cast->hidden[n];
        const CastEntity    *e = &cast->entity[own->entity];
        const ScenarioGroup *g = &s->group[e->group];
        char                 marking[12] = "", shown[64];
        cast_marking(marking, cast, own->entity);
        text_escape(shown, sizeof shown, marking, strnlen(marking, 11));
        for (char *at = shown; *at; at++)
            if (*at == ',' || *at == '"') *at = ' ';
        fprintf(file, "%d:%d:%u,%s,%u.%u.%u.%u.%u.%u.%u,%s,%s,%.3f,%.3f,%d,%.2f,%.2f,%.1f\n", s->dis.site,
                s->dis.application, e->number, shown, e->type.kind, e->type.domain, e->type.country, e->type.category,
                e->type.subcategory, e->type.specific, e->type.extra, scenario_hide_name(g->hide),
                g->net ? "yes" : "no", own->planned, own->judged, own->fit, own->x_m, own->y_m,
                own->heading_rad / rad_per_deg);
    }
}

Status exercise_places(const Cast *cast, const char *path, bool overwrite)
{
    static const double off = 0.1;
    const Scenario     *s = cast->scenario;
    char                place[scenario_place_size];
    int                 far = 0;
    if (!s->ground.planted) {
        if (path) log_error("exercise: --places: no entity hides: `hide` needs ground.planted: true");
        return path ? STATUS_BAD_VALUE : STATUS_OK;
    }
    scenario_place_text(place, s);
    for (int n = 0; n < cast->hidden_count; n++)
        far += !(fabs(cast->hidden[n].planned - cast->hidden[n].judged) <= off);
    log_print("ground: replay it with --set terrain.place=%s --set seed=%lld", place, s->ground.seed);
    if (s->ground.relief_m != 15) log_print(" --set terrain.relief_m=%g", s->ground.relief_m);
    if (s->ground.spacing_m != 4) log_print(" --set terrain.spacing_m=%g", s->ground.spacing_m);
    log_print(" --set terrain.buildings=%s", s->ground.buildings ? "invented" : "off");
    log_print("\nhidden: %d entit%s, %d of them hidden by more than 0.1 more or less than planned\n",
              cast->hidden_count, cast->hidden_count == 1 ? "y" : "ies", far);
    if (!path) return STATUS_OK;
    Status status = overwrite_file("exercise", path, overwrite);
    if (status != STATUS_OK) return status;
    FILE *file = output_begin(path, 0);
    if (file) write_rows(file, cast);
    if (file && output_end(file, path)) return STATUS_OK;
    log_error("exercise: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}
