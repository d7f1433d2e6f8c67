#include <map>

#include "experiments/scenes/hole_plate.h"
#include "tests/experiments/scenes/generated.h"

using namespace ulam;

namespace {

Json grid(Json parameters) {
    parameters["type"] = "grid_of_holes";
    return parameters;
}

/// The truth against brute force in 4 × 4 tiles of the image.
void checkTruth(const Json& generator, int samples) {
    const SceneDescription description = describeGenerator(generator);
    constexpr int kSize = 32, kTile = 8;
    const Json film = {{"width", kSize}, {"height", kSize}};
    const Scene scene = description.build(film);
    const auto truth = description.generator()->truth(description.filmSize(film));
    REQUIRE(truth);
    for (int ty = 0; ty < kSize; ty += kTile)
        for (int tx = 0; tx < kSize; tx += kTile) {
            double expected = 0;
            for (int y = ty; y < ty + kTile; ++y)
                for (int x = tx; x < tx + kTile; ++x) expected += truth->at(x, y).x / double(kTile * kTile);
            const Estimate e =
                directLight(scene, Vec2f(float(tx), float(ty)), Vec2f(float(tx + kTile), float(ty + kTile)), "light",
                            samples, uint32_t(ty * kSize + tx));
            INFO("tile " << tx << " " << ty << ": " << e.mean << " ± " << e.error << ", expected " << expected);
            // 5 standard errors in 16 tiles: a false alarm once in 10⁵.
            CHECK(std::abs(e.mean - expected) <= 5 * e.error + 1e-9);
        }
}

}  // namespace

TEST_CASE("grid_of_holes: the plate is closed and has the volume of its solid part") {
    for (const int sides : {4, 5, 64})
        for (const double pitch : {0.2, 0.25}) {
            HolePlate plate{4, pitch, 0.1, 0.5, {}};
            double open = 0;
            for (int i = 0; i < 16; ++i) {
                const double area = 0.001 * (1 + i);
                open += area;
                plate.outlines.push_back(regularPolygon({0, 0}, area, sides, sides == 4 ? kPi / 4 : 0));
            }
            const Json mesh = plate.mesh().shape({});
            const auto p = mesh["positions"].get<std::vector<double>>();
            const auto t = mesh["triangles"].get<std::vector<size_t>>();
            const auto at = [&](size_t i) { return Vec3d(p[3 * i], p[3 * i + 1], p[3 * i + 2]); };
            double volume = 0;
            std::map<std::pair<size_t, size_t>, int> edges;
            for (size_t i = 0; i < t.size(); i += 3) {
                volume += at(t[i]).dot(at(t[i + 1]).cross(at(t[i + 2]))) / 6;
                for (size_t k = 0; k < 3; ++k) ++edges[{t[i + k], t[i + (k + 1) % 3]}];
            }
            CHECK(volume == Approx((1 - open) * 0.1));
            for (const auto& [edge, count] : edges) {
                REQUIRE(count == 1);
                REQUIRE(edges.count({edge.second, edge.first}) == 1);
            }
        }
}

TEST_CASE("grid_of_holes: light passes through the holes and nowhere else, and features name them as the image does") {
    for (const int n : {1, 3, 8}) {
        const SceneDescription description = describeGenerator(grid({{"holes", n}}));
        const Scene scene = description.build();
        const Vec3f eye = scene.sensor->samplePosition({}).position;
        CHECK(scene.warnings.empty());
        REQUIRE(scene.features.names.size() == size_t(n * n));
        const float cell = float(scene.sensor->width()) / float(n);
        for (int row = 0; row < n; ++row)
            for (int column = 0; column < n; ++column) {
                const Vec2f raster((float(column) + 0.5f) * cell, (float(row) + 0.5f) * cell);
                const Vertex seen = firstHit(scene, eye, scene.sensor->direction(scene.sensor->samplePosition({}), raster));
                REQUIRE(scene.shapes[seen.shape].id == "receiver");
                const Vertex lit = firstHit(scene, seen.position, {0, 0, -1});
                REQUIRE(scene.shapes[lit.shape].id == "light");
                const uint32_t feature = scene.features.crossed(lit.position, seen.position);
                REQUIRE(feature == uint32_t(row * n + column));
                CHECK(scene.features.names[feature] == "hole_" + std::to_string(row) + "_" + std::to_string(column));
                const float aside = 0.4f / float(n);
                for (const float dx : {-aside, aside})
                    CHECK(scene.shapes[firstHit(scene, seen.position + Vec3f(dx, 0, 0), {0, 0, -1}).shape].id ==
                          "plate");
            }
        // What is reflected by the plate's front does not cross a feature.
        CHECK(scene.features.crossed({0.01f, 0.01f, 0}, {0.2f, 0, 0.4f}) == kNone);
    }
}

TEST_CASE("grid_of_holes: the image just holds the unit square of the receiver") {
    for (const int n : {1, 4, 5}) {
        const Scene scene = describeGenerator(grid({{"holes", n}, {"receiver_distance", 0.3}})).build();
        const Vec3f eye = scene.sensor->samplePosition({}).position;
        const float w = float(scene.sensor->width());
        for (const auto& [raster, corner] :
             {std::pair(Vec2f(0, 0), Vec3f(0.5f, 0.5f, 0.3f)), std::pair(Vec2f(w, w), Vec3f(-0.5f, -0.5f, 0.3f))})
            CHECK(length(firstHit(scene, eye, scene.sensor->direction(scene.sensor->samplePosition({}), raster)).position - corner) < 1e-5f);
        // Not in a hole's axis.
        CHECK(scene.shapes[firstHit(scene, eye, {0, 0, -1}).shape].id == "plate");
    }
}

TEST_CASE("grid_of_holes: the truth agrees with brute force") {
    SECTION("thin plate") {
        checkTruth(grid({{"holes", 2}, {"thickness", 0}, {"open_area", 0.3}}), 20000);
    }
    SECTION("thick plate") {
        checkTruth(grid({{"holes", 3}, {"thickness", 0.15}, {"open_area", 0.3}, {"polygon_sides", 9}}), 60000);
    }
    SECTION("square holes of unequal areas, close together") {
        checkTruth(grid({{"holes", 3},
                         {"pitch", 0.2},
                         {"shape", "square"},
                         {"weights", "geometric"},
                         {"open_area", 0.1},
                         {"thickness", 0.1}}),
                   60000);
    }
    SECTION("one bright hole") {
        checkTruth(grid({{"holes", 2}, {"weights", "one_bright"}, {"open_area", 0.15}, {"thickness", 0.2}}), 60000);
    }
}

TEST_CASE("grid_of_holes: pixels of the truth add up, whatever their size") {
    const SceneDescription description = describeGenerator(grid({{"holes", 4}}));
    const Image coarse = *description.generator()->truth(square(16)),
                fine = *description.generator()->truth(square(48));
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            double sum = 0;
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) sum += fine.at(3 * x + i, 3 * y + j).x / 9.0;
            REQUIRE(coarse.at(x, y).x == Approx(sum).epsilon(1e-4).margin(1e-5));
        }
    const Image crop = *description.generator()->truth({48, 48, 10, 20, 5, 6});
    CHECK(crop.width == 5);
    CHECK(crop.at(2, 3) == fine.at(12, 23));
}

TEST_CASE("grid_of_holes: the mean is near 0.5 whatever the knobs") {
    for (const Json& knobs : {Json::object(), Json{{"thickness", 0}}, Json{{"holes", 16}}, Json{{"open_area", 0.3}},
                              Json{{"thickness", 0.4}, {"holes", 4}}}) {
        const double mean = meanOf(*describeGenerator(grid(knobs)).generator()->truth(square(32)));
        INFO(knobs.dump());
        CHECK(mean > 0.3);
        CHECK(mean < 0.7);
    }
}

TEST_CASE("grid_of_holes: shares of the holes") {
    const auto shares = [](const Json& knobs) { return describeGenerator(grid(knobs)).generator()->featureShares(); };
    for (const Json& knobs : {Json{{"holes", 1}}, Json{{"holes", 5}}, Json{{"holes", 8}, {"thickness", 0}},
                              Json{{"weights", "geometric"}, {"holes", 4}}}) {
        double sum = 0;
        for (const double share : shares(knobs)) sum += share;
        CHECK(sum == Approx(1).epsilon(1e-12));
    }
    for (const double share : shares({{"holes", 2}})) CHECK(share == Approx(0.25).epsilon(1e-6));
    const auto falling = shares({{"weights", "geometric"}, {"holes", 4}});
    for (size_t i = 0; i < falling.size(); ++i) {
        if (i % 4 > 0) {
            CHECK(falling[i] < falling[i - 1] / 2);
        }
    }
    CHECK(shares({{"back", "hidden"}}).empty());
}

TEST_CASE("grid_of_holes: there is a truth only where direct light is all and the emitter reaches far enough") {
    const auto solvable = [](const Json& knobs) {
        return describeGenerator(grid(knobs)).generator()->truth(square(8)).has_value();
    };
    CHECK(solvable(Json::object()));
    CHECK(solvable({{"receiver", {{"type", "diffuse"}, {"reflectance", {0.1, 0.2, 0.3}}}}}));
    CHECK_FALSE(solvable({{"back", "hidden"}}));
    CHECK_FALSE(solvable({{"back", "small"}}));
    CHECK_FALSE(solvable({{"room", true}}));
    CHECK_FALSE(solvable({{"glass_panes", 1}}));
    CHECK_FALSE(solvable({{"plate", {{"type", "diffuse"}}}}));
    CHECK_FALSE(solvable({{"receiver", {{"type", "conductor"}}}}));
    CHECK_FALSE(solvable({{"receiver_distance", 0.02}, {"thickness", 0}}));
    CHECK_FALSE(describeGenerator(grid(Json::object())).generator()->truth({64, 32, 0, 0, 64, 32}).has_value());
}

TEST_CASE("grid_of_holes: hidden and small light, room and panes") {
    for (const char* back : {"hidden", "small"}) {
        const Scene scene =
            describeGenerator(grid({{"back", back}, {"holes", 3}, {"room", true}, {"glass_panes", 2}})).build();
        CHECK(scene.warnings.empty());
        const uint32_t light = shapeNamed(scene, "light");
        Random random({31, 32}, 0, 0);
        for (int i = 0; i < 200; ++i) {
            const Vertex lit = scene.shapes[light].samplePoint(light, random(), random());
            CHECK(lit.normal.z == Approx(std::string(back) == "hidden" ? -1 : 1));
            // The chamber is closed: what leaves it without glass meets plate, chamber, receiver or room.
            const Vec3f direction = squareToSphere(random(), random());
            Hit hit{};
            CHECK(scene.rays().intersect(lit.position + lit.normal * 1e-4f, direction, hit));
        }
    }
}

TEST_CASE("grid_of_holes: knobs that do not fit together") {
    CHECK_THROWS_WITH(describeGenerator(grid({{"open_area", 0.75}, {"shape", "round"}, {"weights", "one_bright"}})),
                      Catch::Contains("does not fit into the pitch"));
    CHECK_THROWS_WITH(describeGenerator(grid({{"holes", 4}, {"pitch", 0.3}})), Catch::Contains("wider than the plate"));
    CHECK_THROWS_WITH(describeGenerator(grid({{"holes", 32}, {"weights", "geometric"}})), Catch::Contains("hole_0_"));
    CHECK_THROWS_WITH(describeGenerator(grid({{"holes", 0}})), Catch::Contains("/holes"));
    CHECK_THROWS_WITH(describeGenerator(grid({{"plate", {{"type", "difuse"}}}})), Catch::Contains("diffuse"));
    CHECK_THROWS_WITH(describeGenerator(grid({{"open_are", 0.1}})), Catch::Contains("open_area"));
}
