/* sensor/verify/saved_frame/saved_fields_scenery.c: scenery of a frame file: what it follows from, and the records of
 * culture that came from files. */
#include "sensor/verify/saved_frame/saved_frame_private.h"

#include "terrain/surface.h"

static const float steep_rad = 100; /* angles are any number of turns */

static void byte_field(Fields *f, const char *name, uint8_t *value, int high)
{
    int number = *value;
    field_int(f, name, &number, 0, high);
    *value = (uint8_t)number;
}

static void corner_fields(Fields *f, void *record)
{
    field_reals(f, "corner of culture", record, 2, culture_farthest_m);
}

static void building_fields(Fields *f, void *record)
{
    Building *b = record;
    field_u64(f, &b->id);
    field_int(f, "corners of a building", &b->first_corner, 0, culture_most_corners);
    field_int(f, "corners of a building", &b->corners, 3, culture_outline_most);
    field_floats(f, "base of a building", &b->base_m, 1, (float)-local_m, (float)local_m);
    field_floats(f, "height of a building", &b->eaves_m, 1, 0, culture_highest_m);
    field_floats(f, "height of a building", &b->ridge_m, 1, 0, culture_highest_m);
    field_floats(f, "ridge of a building", &b->ridge_rad, 1, -steep_rad, steep_rad);
    byte_field(f, "use of a building", &b->use, BUILDING_USES - 1);
    byte_field(f, "roof of a building", &b->roof, ROOF_SHAPES - 1);
    byte_field(f, "walls of a building", &b->wall_fabric, FABRICS - 1);
    byte_field(f, "roof of a building", &b->roof_fabric, FABRICS - 1);
    byte_field(f, "levels of a building", &b->levels, 100);
    field_bool(f, "heating of a building", &b->heated);
    byte_field(f, "chimneys of a building", &b->chimneys, 4);
    byte_field(f, "damage of a building", &b->damage, 3);
}

static void line_fields(Fields *f, void *record)
{
    CultureLine *l = record;
    field_u64(f, &l->id);
    field_int(f, "corners of a line", &l->first_corner, 0, culture_most_corners);
    field_int(f, "corners of a line", &l->corners, 2, culture_outline_most);
    field_floats(f, "width of a line", &l->width_m, 1, 0, culture_widest_m);
    field_floats(f, "height of a line", &l->height_m, 1, 0, culture_highest_m);
    byte_field(f, "kind of a line", &l->kind, CULTURE_LINE_KINDS - 1);
    byte_field(f, "surface of a line", &l->surface, SURFACE_COUNT - 1);
}

static void point_fields(Fields *f, void *record)
{
    CulturePoint *p = record;
    field_u64(f, &p->id);
    field_real(f, "place of a point", &p->x_m, -culture_farthest_m, culture_farthest_m);
    field_real(f, "place of a point", &p->y_m, -culture_farthest_m, culture_farthest_m);
    field_floats(f, "base of a point", &p->base_m, 1, (float)-local_m, (float)local_m);
    field_floats(f, "heading of a point", &p->heading_rad, 1, -steep_rad, steep_rad);
    field_floats(f, "size of a point", p->size_m, 3, 0, culture_widest_m);
    byte_field(f, "kind of a point", &p->kind, CULTURE_POINT_KINDS - 1);
}

static void tree_fields(Fields *f, void *record)
{
    CultureTree *t = record;
    field_u64(f, &t->id);
    field_real(f, "place of a tree", &t->x_m, -culture_farthest_m, culture_farthest_m);
    field_real(f, "place of a tree", &t->y_m, -culture_farthest_m, culture_farthest_m);
    field_floats(f, "height of a tree", &t->height_m, 1, 0, 200);
    byte_field(f, "kind of a tree", &t->kind, UINT8_MAX);
    byte_field(f, "mark of a tree", &t->mark, PLANT_MARKS - 1);
}

static void record_lists(Fields *f, Culture *c)
{
    enum { most = culture_most_records };
    field_list(f, &c->corners, (void **)&c->corner_m, sizeof *c->corner_m, culture_most_corners, corner_fields);
    field_list(f, &c->buildings, (void **)&c->building, sizeof *c->building, most, building_fields);
    field_list(f, &c->lines, (void **)&c->line, sizeof *c->line, most, line_fields);
    field_list(f, &c->points, (void **)&c->point, sizeof *c->point, most, point_fields);
    field_list(f, &c->trees, (void **)&c->tree, sizeof *c->tree, most, tree_fields);
    if (!f->from || !fields_good(f)) return;
    const char *fault = culture_fault(c);
    if (fault) f->fault = fault;
}

static void driven_fields(Fields *f, void *record)
{
    DrivenPath *p = record;
    field_reals(f, "path of a vehicle", p->a_m, 2, 2 * culture_farthest_m);
    field_reals(f, "path of a vehicle", p->b_m, 2, 2 * culture_farthest_m);
    field_real(f, "width of a path", &p->half_m, 0, 1000);
}

/* All paths are no longer than what a thousand vehicles drive in a day: what is made along them has that limit. */
static void driven_list(Fields *f, SavedScenery *s)
{
    static const double most_m = 1e9;
    double              sum_m = 0;
    field_list(f, &s->drivens, (void **)&s->driven, sizeof *s->driven, landscape_parts_rows, driven_fields);
    if (!f->from || !fields_good(f)) return;
    for (int n = 0; n < s->drivens; n++)
        sum_m += hypot(s->driven[n].b_m[0] - s->driven[n].a_m[0], s->driven[n].b_m[1] - s->driven[n].a_m[1]);
    if (!(sum_m <= most_m)) f->fault = "paths of vehicles";
}

/* Only of a table that is not countryside, or where paths follow. */
static void table_field(Fields *f, char *named, size_t size, bool more)
{
    const bool other = f->from ? f->from->at < f->from->end : more || (*named && strcmp(named, "countryside") != 0);
    if (other) field_chars(f, "table of clutter", named, size);
    else if (f->from) *named = 0;
}

void saved_fields_scenery(Fields *f, SavedFrame *file)
{
    SceneryPlan *plan = &file->scenery.plan;
    int          from = (int)plan->from;
    file->built = true;
    field_int(f, "culture", &from, CULTURE_FROM_NOTHING, CULTURE_FROMS - 1);
    plan->from = (CultureFrom)from;
    field_u64(f, &plan->invented.seed);
    field_reals(f, "centre of culture", plan->invented.centre_m, 2, 1e6);
    field_real(f, "width of culture", &plan->invented.half_width_m, 0, 1e6);
    field_real(f, "clutter", &plan->clutter, 0, 20);
    field_u64(f, &plan->clutter_seed);
    field_reals(f, "place of clutter", plan->south_west_m, 2, 2e6);
    field_reals(f, "place of clutter", plan->north_east_m, 2, 2e6);
    field_int(f, "objects of scenery", &file->scenery.objects, 0, INT32_MAX - 1);
    field_chars(f, "scenery sha256", file->scenery.sha256, sizeof file->scenery.sha256);
    if (plan->from == CULTURE_FROM_RECORDS) record_lists(f, &file->scenery.culture);
    SavedScenery *s = &file->scenery;
    table_field(f, plan->clutter_table, sizeof plan->clutter_table, s->drivens > 0);
    if (f->from ? f->from->at < f->from->end : s->drivens > 0) /* last */
        driven_list(f, s);
}

/* A file without this chunk is of a frame whose scenery had neither. */
void saved_fields_shows(Fields *f, SavedFrame *file)
{
    field_bool(f, "lamps", &file->scenery.plan.lamps);
    field_bool(f, "smoke of fires", &file->scenery.plan.smoke);
    field_int(f, "damage of buildings", &file->scenery.plan.harms, 0, building_harms_most);
    for (int k = 0; k < file->scenery.plan.harms && fields_good(f); k++) {
        BuildingHarm *h = &file->scenery.plan.harm[k];
        field_u64(f, &h->building);
        field_real(f, "time of damage", &h->t_s, -1e12, 1e12);
        byte_field(f, "damage of a building", &h->damage, model_damage_states - 1);
    }
}
