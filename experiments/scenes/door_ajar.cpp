// Door ajar: a room lit through the gap of a door by a lamp in the next room (after Veach and Guibas 1997, "Metropolis
// Light Transport", section 7; sizes as in the scene that circulates). y up. The lamp faces away from the doorway, so
// that light is reflected at least once before it comes to the gap. A frame fills what the door leaves of the doorway:
// closed, the door would shut it tight; ajar, light comes through the gap and, a little of it, over the door.

#include "core/scene/generator.h"
#include "experiments/scenes/parts.h"

namespace ulam {
namespace {

struct Room {
    double x0, x1, z0, z1;
};
constexpr Room kViewerRoom{-202.9, 176.2, -73.0, 230.3}, kLightRoom{-202.4, 176.7, -395.1, -77.05};
constexpr double kHeight = 145;
constexpr double kDoorwayX0 = 58.7, kDoorwayX1 = 121.9, kDoorwayHeight = 123.3;
const Vec3d kHinge(62.0, 0, -72.4);  // where the door's back meets the floor
constexpr double kDoorWidth = 59.7, kDoorHeight = 121, kDoorThickness = 2.1;
constexpr double kLampX0 = -117.2, kLampX1 = 34.4, kLampY0 = 76.6, kLampY1 = 136.6, kLampZ = -321.8;
const Spectrum kLampRadiance{1704, 1852, 1950};
constexpr double kReflectance = 0.73;
const Spectrum kDoorWood{0.6, 0.45, 0.3}, kTableWood{0.33, 0.22, 0.12};
const Vec3d kTable(-45, 42, 75);  // middle of its top
constexpr double kTableHalfX = 44, kTableHalfZ = 30, kTableThickness = 3, kLeg = 4;
constexpr double kPotRadius = 8.5, kPotHeight = 12, kPotSpacing = 20, kLidKnob = 1.8;
constexpr int kPotsInARow = 4;

class DoorAjar : public Generator {
public:
    struct Parameters {
        double angle = 17.3, floorAlpha = 0.04, lampSize = 1;
        std::string floor = "diffuse";
        int objects = 3;
        template <class V>
        void describe(V& v) {
            v("angle", angle, {.help = "by which the door is open; 17.3: a gap of 18.0", .unit = "degrees", .min = 0.5, .max = 90});
            v("floor", floor, {.help = "what the floor is made of", .choices = {"diffuse", "rough_plastic"}});
            v("floor_alpha", floorAlpha, {.help = "roughness of a floor of rough plastic", .min = 1e-4, .max = 1});
            v("lamp_size", lampSize, {.help = "factor on both sides of the lamp, 151.6 × 60; its power stays", .min = 0.01, .max = 1});
            v("objects", objects, {.help = "pots on the table: of rough metal, diffuse, of rough glass, and so on", .min = 0, .max = 12});
        }
    };
    explicit DoorAjar(const Parameters& parameters) : p_(parameters) {}

    Json expand() const override {
        Json scene = {{"type", "scene"},
                      {"sensor", View{{-71.39, 71.49, 205.3}, {-71.1997, 71.4202, 204.321}, {0, 1, 0}, 54, 320, 180}.sensor()}};
        addRooms(scene);
        MeshBuilder door;
        const double angle = p_.angle * kPi / 180;
        door.box(kHinge, leaf(), {0, kDoorHeight, 0}, Vec3d(-std::sin(angle), 0, std::cos(angle)) * kDoorThickness);
        scene["door"] = door.shape(diffuse(kDoorWood));
        addLamp(scene);
        addTable(scene);
        return scene;
    }

    Features features() const override {
        const Vec3d jamb = kHinge + Vec3d(kDoorWidth, kDoorHeight, 0), edge = kHinge + leaf() + Vec3d(0, kDoorHeight, 0);
        return {Vec3f(jamb), Vec3f(edge - jamb), {0, float(-kDoorHeight), 0}, 1, 1, {"gap"}};
    }

private:
    /// The door's lower edge, away from the hinge.
    Vec3d leaf() const {
        const double angle = p_.angle * kPi / 180;
        return Vec3d(std::cos(angle), 0, std::sin(angle)) * kDoorWidth;
    }

    void addRooms(Json& scene) const {
        MeshBuilder walls, floor, frame;
        for (const Room& room : {kViewerRoom, kLightRoom}) {
            const auto arch = [](double x0, double x1, double height, double z) {
                return std::vector<Vec3d>{{x0, 0, z}, {x0, height, z}, {x1, height, z}, {x1, 0, z}};
            };
            const auto whole = [&](double z) { return arch(room.x0, room.x1, kHeight, z); };
            const auto doorway = [&](double z) { return arch(kDoorwayX0, kDoorwayX1, kDoorwayHeight, z); };
            walls.strip(whole(room.z1), whole(room.z0));
            floor.quad({room.x0, 0, room.z1}, {room.x1, 0, room.z1}, {room.x1, 0, room.z0}, {room.x0, 0, room.z0});
            if (room.z0 == kViewerRoom.z0) {
                walls.strip(whole(room.z0), doorway(room.z0));
                const std::vector<Vec3d> back = whole(room.z1);
                walls.quad(back[0], back[1], back[2], back[3]);
            } else {
                walls.strip(doorway(room.z1), whole(room.z1));
                const std::vector<Vec3d> back = whole(room.z0);
                walls.quad(back[3], back[2], back[1], back[0]);
            }
        }
        const double x0 = kHinge.x, x1 = kHinge.x + kDoorWidth, z0 = kLightRoom.z1, z1 = kViewerRoom.z0;
        floor.quad({x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}, {x0, 0, z0});
        frame.box({kDoorwayX0, 0, z0}, {x0, kDoorwayHeight, kHinge.z});
        frame.box({x1, 0, z0}, {kDoorwayX1, kDoorwayHeight, kHinge.z});
        frame.box({x0, kDoorHeight, z0}, {x1, kDoorwayHeight, kHinge.z});
        scene["walls"] = walls.shape(diffuse(kReflectance));
        scene["floor"] = floor.shape(p_.floor == "diffuse"
                                         ? diffuse(kReflectance)
                                         : Json{{"type", "roughplastic"}, {"alpha", p_.floorAlpha}, {"diffuse_reflectance", kReflectance}});
        scene["frame"] = frame.shape(diffuse(kDoorWood));
    }

    void addLamp(Json& scene) const {
        const double x = (kLampX0 + kLampX1) / 2, y = (kLampY0 + kLampY1) / 2;
        const double w = (kLampX1 - kLampX0) / 2 * p_.lampSize, h = (kLampY1 - kLampY0) / 2 * p_.lampSize;
        MeshBuilder lamp;
        lamp.quad({x + w, y - h, kLampZ}, {x - w, y - h, kLampZ}, {x - w, y + h, kLampZ}, {x + w, y + h, kLampZ});
        scene["lamp"] = emitting(lamp.shape({}), Spectrum(kLampRadiance / (p_.lampSize * p_.lampSize)));
    }

    void addTable(Json& scene) const {
        MeshBuilder table;
        const Vec3d half(kTableHalfX, 0, kTableHalfZ), thick(0, kTableThickness, 0);
        table.box(kTable - half - thick, kTable + half);
        for (const double x : {-kTableHalfX + kLeg, kTableHalfX - 2 * kLeg})
            for (const double z : {-kTableHalfZ + kLeg, kTableHalfZ - 2 * kLeg}) {
                const Vec3d foot(kTable.x + x, 0, kTable.z + z);
                table.box(foot, foot + Vec3d(kLeg, kTable.y - kTableThickness, kLeg));
            }
        scene["table"] = table.shape(diffuse(kTableWood));

        const std::array<Json, 3> materials{metal("Al", 0.03), diffuse(Spectrum(0.7, 0.25, 0.15)), glass(0.02, 1.5)};
        const int rows = (p_.objects + kPotsInARow - 1) / kPotsInARow;
        for (int i = 0; i < p_.objects; ++i) {
            const int row = i / kPotsInARow, column = i % kPotsInARow, inRow = std::min(kPotsInARow, p_.objects - row * kPotsInARow);
            const Vec3d place = kTable + Vec3d(column - (inRow - 1) / 2.0, 0, row - (rows - 1) / 2.0) * kPotSpacing;
            addPot(scene, i, place, materials[size_t(i) % materials.size()]);
        }
    }

    /// A body between sphere and cylinder, and a ball on top of it.
    static void addPot(Json& scene, int number, const Vec3d& place, const Json& bsdf) {
        constexpr int kProfile = 48, kSides = 64;
        constexpr double kPower = 0.7, kAboveTable = 0.05;
        std::vector<Imath::V2d> profile;
        for (int i = 0; i <= kProfile; ++i) {
            const double angle = kPi * (double(i) / kProfile - 0.5), sine = std::sin(angle);
            const double radius = i == 0 || i == kProfile ? 0 : kPotRadius * std::pow(std::cos(angle), kPower);
            profile.emplace_back(radius, kPotHeight / 2 * (1 + std::copysign(std::pow(std::abs(sine), kPower), sine)));
        }
        const Vec3d base = place + Vec3d(0, kAboveTable, 0);
        MeshBuilder body;
        body.revolution(profile, base, kSides);
        scene[fmt::format("pot_{}", number)] = smooth(body.shape(bsdf));
        scene[fmt::format("lid_{}", number)] = sphere(base + Vec3d(0, kPotHeight + kLidKnob + kAboveTable, 0), kLidKnob, bsdf);
    }

    Parameters p_;
};

ULAM_REGISTER_GENERATOR(DoorAjar, "door_ajar", "a room lit through the gap of a door by a lamp in the next room");

}  // namespace
}  // namespace ulam
