/* sensor/node/shape_choice.c: types that are not rendered, or only with a default shape. */
#include "sensor/node/shape_choice.h"

#include <stdio.h>

enum { most_named = 4 };

static bool same_type(DisEntityType a, DisEntityType b)
{
    return a.kind == b.kind && a.domain == b.domain && a.country == b.country && a.category == b.category &&
           a.subcategory == b.subcategory && a.specific == b.specific && a.extra == b.extra;
}

typedef struct Unshaped {
    int entities, types, named;
    DisEntityType type[most_named];
} Unshaped;

static void note(Unshaped *u, DisEntityType type)
{
    u->entities++;
    for (int i = 0; i < u->named; i++)
        if (same_type(u->type[i], type)) return;
    u->types++; /* a type beyond the stored ones may be counted again */
    if (u->named < most_named) u->type[u->named++] = type;
}

static void say(Choices *choices, const Unshaped *u, const char *what, const char *how)
{
    char text[160] = "";
    size_t n = 0;
    if (u->entities == 0) return;
    for (int i = 0; i < u->named && n < sizeof text; i++) {
        char type[dis_type_text_size];
        dis_entity_type_text(type, u->type[i]);
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%s", i ? ", " : "", type);
    }
    choice_add(choices, "shapes: %s of %d %s (%s%s); %s", what, u->entities, u->entities == 1 ? "entity" : "entities",
               text, u->types > u->named ? ", ..." : "", how);
}

void choose_shapes(Choices *choices, const Survey *survey, const Catalog *catalog)
{
    Unshaped unseen = {0}, unknown = {0}, chaff = {0};
    for (int i = 0; i < survey->track_count; i++) {
        const DisEntityType type = survey->track[i].type;
        int matched;
        const int model = catalog_find(catalog, type, NULL, &matched);
        if (catalog_is_chaff(catalog, model))
            note(&chaff, type);
        else if (!catalog_has_shape(catalog, model))
            note(&unseen, type);
        else if (model == 0)
            note(&unknown, type);
    }
    say(choices, &unseen, "nothing is seen", "`none` in etc/catalog.csv");
    say(choices, &chaff, "nothing is seen, but by radar.preset,", "`chaff` in etc/catalog.csv");
    say(choices, &unknown, "a wedge is shown", "no row of etc/catalog.csv");
}
