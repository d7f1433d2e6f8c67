// Mitsuba's XML as scene dictionaries, in both spellings; and what is refused.

#include "core/scene/loading/spectra.h"
#include "core/scene/mitsuba/upgrade.h"
#include "core/scene/mitsuba/xml.h"
#include "tests/support/error_of.h"
#include "tests/core/scene/load_text.h"

#include <fstream>

using namespace ulam;

namespace {

/// Reads one scene from text.
struct XmlScene {
    SceneFolder folder{"mitsuba_xml"};

    JsonDocument read(const std::string& content, const std::string& version = "3.0.0", const SceneFileOptions& options = {}) const {
        folder.write("scene.xml", "<scene version=\"" + version + "\">\n" + content + "\n</scene>\n");
        return readMitsubaXml(folder.path / "scene.xml", options);
    }
    Complaint complaint(const std::string& content, const std::string& version = "3.0.0") const {
        return errorOf([&] { read(content, version); });
    }
};

void near(const Json& colour, double r, double g, double b) {
    INFO(colour.dump());
    REQUIRE(colour.size() == 3);
    CHECK(colour[0].get<double>() == Approx(r).epsilon(2e-3));
    CHECK(colour[1].get<double>() == Approx(g).epsilon(2e-3));
    CHECK(colour[2].get<double>() == Approx(b).epsilon(2e-3));
}

}  // namespace

TEST_CASE("elements become the values of a dictionary") {
    const Json scene = XmlScene{}.read(R"(
        <shape type="sphere" id="ball">
            <point name="center" x="1" y="-2" z="3e1"/>
            <float name="radius" value=" 2.5 "/>
            <boolean name="flip_normals" value="True"/>
            <bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf>
            <emitter type="area"><rgb name="radiance" value="1, 2 3"/></emitter>
        </shape>
        <shape type="sphere"/><shape type="sphere"/>
        <integrator type="path"><integer name="max_depth" value="-1"/></integrator>)").json();
    CHECK(scene == Json::parse(R"({"type": "scene",
        "ball": {"type": "sphere", "id": "ball", "center": [1.0, -2.0, 30.0], "radius": 2.5, "flip_normals": true,
                 "bsdf": {"type": "dielectric", "int_ior": "bk7"}, "emitter": {"type": "area", "radiance": [1.0, 2.0, 3.0]}},
        "shape": {"type": "sphere"}, "shape_2": {"type": "sphere"},
        "integrator": {"type": "path", "max_depth": -1}})"));
}

TEST_CASE("a transformation is its steps in order") {
    const Json ball = entry(XmlScene{}.read(R"(<shape type="sphere" id="s"><transform name="to_world">
        <scale value="2"/><scale x="3"/><rotate y="1" angle="90"/><translate x="1" z="2"/>
        <lookat origin="0,0,1" target="0 0 0" up="0 1 0"/>
        <matrix value="1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1"/><matrix value="1 2 3 4 5 6 7 8 9"/></transform></shape>)"), "s");
    CHECK(ball["to_world"] == Json::parse(R"([{"type": "scale", "value": [2.0, 2.0, 2.0]}, {"type": "scale", "value": [3.0, 1.0, 1.0]},
        {"type": "rotate", "axis": [0.0, 1.0, 0.0], "angle": 90.0}, {"type": "translate", "value": [1.0, 0.0, 2.0]},
        {"type": "lookat", "origin": [0.0, 0.0, 1.0], "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0]},
        {"type": "matrix", "value": [1.0, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 6.0, 0.0, 0.0, 1.0, 7.0, 0.0, 0.0, 0.0, 1.0]},
        {"type": "matrix", "value": [1.0, 2.0, 3.0, 0, 4.0, 5.0, 6.0, 0, 7.0, 8.0, 9.0, 0, 0, 0, 0, 1]}])"));
}

TEST_CASE("the spelling of Mitsuba 0.6 is brought to that of Mitsuba 3") {
    CHECK(underscored("toWorld") == "to_world");
    CHECK(underscored("intIOR") == "int_ior");
    CHECK(underscored("flipTexCoords") == "flip_tex_coords");
    CHECK(underscored("p0") == "p0");
    const auto old = XmlScene{}.read(R"(
        <bsdf type="roughplastic" id="a"><srgb name="diffuseReflectance" value="#ff8000"/><float name="intIOR" value="1.5"/></bsdf>
        <bsdf type="diffuse" id="b"><spectrum name="diffuseReflectance" value="0.1, 0.2, 0.3"/></bsdf>
        <bsdf type="conductor" id="c"/>
        <bsdf type="conductor" id="d"><string name="material" value="Au"/><string name="extEta" value="air"/></bsdf>
        <bsdf type="diffuse" id="e"><texture type="bitmap" name="reflectance"><string name="filename" value="a.png"/>
            <string name="filterType" value="ewa"/><float name="gamma" value="1"/><float name="uscale" value="4"/><float name="voffset" value=".5"/>
        </texture></bsdf>
        <sensor type="perspective" id="s"><float name="fov" value="40"/><transform name="toWorld">
            <lookAt origin="0 0 5" target="0 0 0" up="0 1 0"/></transform></sensor>)", "0.6.0").json();
    CHECK(old["a"]["int_ior"] == 1.5);
    near(old["a"]["diffuse_reflectance"], 1, 0.2159, 0);
    CHECK(old["b"] == Json::parse(R"({"type": "diffuse", "id": "b", "reflectance": [0.1, 0.2, 0.3]})"));
    CHECK(old["c"]["material"] == "Cu");
    CHECK(!old["d"].contains("ext_eta"));
    CHECK(old["e"]["reflectance"] == Json::parse(R"({"type": "bitmap", "filename": "a.png", "filter_type": "bilinear",
        "to_uv": [{"type": "scale", "value": [4.0, 1.0, 1]}, {"type": "translate", "value": [0.0, 0.5, 0]}], "raw": true})"));
    CHECK(old["s"]["to_world"][0]["type"] == "lookat");
    // Mitsuba 3 has none of this.
    CHECK(XmlScene{}.complaint(R"(<bsdf type="diffuse"><srgb name="reflectance" value="#ff8000"/></bsdf>)").has("no element <srgb>"));
    CHECK(XmlScene{}.complaint(R"(<shape type="sphere"/>)", "0.3.0").has("scenes of Mitsuba 0.3.0 are not read"));
}

// Expected: what Mitsuba 3.9 (scalar_rgb) makes of the same elements.
TEST_CASE("spectra become colours as in Mitsuba 3") {
    const Json scene = XmlScene{}.read(R"(
        <bsdf type="diffuse" id="curve"><spectrum name="reflectance" value="400:0.1, 500:0.9, 600:0.2, 700:0.4"/></bsdf>
        <bsdf type="diffuse" id="grey"><spectrum name="reflectance" value="0.4"/></bsdf>
        <bsdf type="diffuse" id="white"><spectrum name="reflectance" value="380:1 , 720:1"/></bsdf>
        <emitter type="constant" id="lamp"><spectrum name="radiance" value="400:0.1, 500:9, 600:2, 700:4"/></emitter>
        <emitter type="point" id="even"><spectrum name="intensity" value="3"/></emitter>)").json();
    near(scene["curve"]["reflectance"], 0.0499287, 0.64263, 0.531135);
    CHECK(scene["grey"]["reflectance"] == 0.4);
    near(scene["white"]["reflectance"], 0.998251, 0.998986, 0.998549);
    near(scene["lamp"]["radiance"], 1.2001, 6.0915, 4.28066);
    near(scene["even"]["intensity"], 3.61438, 2.84487, 2.72675);
}

TEST_CASE("a black body's luminance is that of Planck's law under the observer") {
    // A black body of 2856 K is illuminant A, whose chromaticity is (0.44758, 0.40745) (CIE 015:2018).
    const Imath::V3d rgb = blackbodyRgb(2856);
    const double x = 0.412453 * rgb.x + 0.357580 * rgb.y + 0.180423 * rgb.z, y = 0.212671 * rgb.x + 0.715160 * rgb.y + 0.072169 * rgb.z,
                 z = 0.019334 * rgb.x + 0.119193 * rgb.y + 0.950227 * rgb.z;
    CHECK(x / (x + y + z) == Approx(0.44758).margin(5e-4));
    CHECK(y / (x + y + z) == Approx(0.40745).margin(5e-4));
    // The sum of Planck's law times the observer over its own steps of 5 nm, made apart from this program.
    CHECK(y == Approx(270.61).epsilon(1e-3));
}

TEST_CASE("definitions: $names, the file's defaults, and those of the user, which win") {
    const XmlScene xml;
    const std::string content = R"(<default name="size" value="2"/><default name="sizes" value="3"/>
        <shape type="sphere" id="a"><float name="radius" value="$size"/></shape>
        <shape type="sphere" id="b"><float name="radius" value="1$sizes"/></shape>
        <shape type="sphere" id="c"><string name="note" value="\$size"/></shape>)";
    const Json plain = xml.read(content).json(), other = xml.read(content, "3.0.0", {.definitions = {{"size", "7"}}}).json();
    CHECK(plain["a"]["radius"] == 2.0);
    CHECK(plain["b"]["radius"] == 13.0);
    CHECK(plain["c"]["note"] == "$size");
    CHECK(other["a"]["radius"] == 7.0);
    CHECK(xml.complaint(R"(<default name="size" value="2"/><shape type="$siez"/>)").has("did you mean \"size\""));
    const Complaint unused = errorOf([&] { xml.read(content, "3.0.0", {.definitions = {{"spp", "7"}}}); });
    CHECK(unused.code == ExitCode::Usage);
    CHECK(unused.has("$spp"));
}

TEST_CASE("references: aliases, and what is nested in others") {
    const Json scene = XmlScene{}.read(R"(
        <bsdf type="twosided"><bsdf type="diffuse" id="inner"/></bsdf>
        <bsdf type="plastic" id="p"/><alias id="p" as="q"/><alias id="q" as="r"/>
        <shape type="sphere" id="s"><ref id="inner"/></shape><shape type="sphere" id="t"><ref name="bsdf" id="r"/></shape>)").json();
    CHECK(scene["inner"] == Json::parse(R"({"type": "diffuse", "id": "inner"})"));
    CHECK(scene["bsdf"]["bsdf"] == Json::parse(R"({"type": "ref", "id": "inner"})"));
    CHECK(scene["s"]["ref"]["id"] == "inner");
    CHECK(scene["t"]["bsdf"]["id"] == "p");
}

TEST_CASE("references: into what is nested in other plugins that move, or that are replaced") {
    const Json scene = XmlScene{}.read(R"(
        <shape type="sphere" id="s"><bsdf type="twosided" id="a"><bsdf type="diffuse" id="b"/></bsdf></shape>
        <alias id="b" as="c"/><shape type="sphere" id="t"><ref id="a"/></shape><shape type="sphere" id="u"><ref id="c"/></shape>)").json();
    CHECK(scene["s"]["bsdf"] == Json::parse(R"({"type": "ref", "id": "a"})"));
    CHECK(scene["a"] == Json::parse(R"({"type": "twosided", "id": "a", "bsdf": {"type": "ref", "id": "b"}})"));
    CHECK(scene["b"] == Json::parse(R"({"type": "diffuse", "id": "b"})"));
    CHECK(scene["u"]["ref"]["id"] == "b");
    const Json lenient = XmlScene{}.read(R"(<bsdf type="marble" id="m"><ref id="x"/></bsdf><medium type="m"><ref id="y"/></medium>)", "3.0.0",
                                         {.definitions = {}, .lenient = true}).json();
    CHECK(lenient["m"] == Json::parse(R"({"type": "diffuse", "id": "m", "reflectance": [1, 0, 1]})"));
    CHECK_FALSE(lenient.contains("medium"));
}

TEST_CASE("bump maps, normal maps and mixtures of old files are brought to the new words") {
    const XmlScene xml;
    const std::string picture = R"(<texture type="bitmap" id="t"><string name="filename" value="a.png"/></texture>)";
    const auto read = [&](const std::string& bsdf) { return entry(xml.read(picture + bsdf, "0.6.0"), "b"); };
    const Json bumped = read(R"(<bsdf type="bumpmap" id="b"><texture type="scale"><float name="scale" value="3"/><ref id="t"/></texture><bsdf type="diffuse"/></bsdf>)");
    CHECK(bumped["scale"] == 3.0);
    CHECK(bumped["texture"] == Json::parse(R"({"type": "ref", "id": "t"})"));
    const Json inlined = read(R"(<bsdf type="bumpmap" id="b"><texture type="scale"><float name="scale" value="2"/><texture type="checkerboard"/></texture><bsdf type="diffuse"/></bsdf>)");
    CHECK(inlined["texture"]["type"] == "checkerboard");
    CHECK(read(R"(<bsdf type="normalmap" id="b"><texture type="bitmap"><string name="filename" value="n.png"/></texture><bsdf type="diffuse"/></bsdf>)")["normalmap"]["type"] == "bitmap");
    CHECK(read(R"(<bsdf type="mixturebsdf" id="b"><string name="weights" value="0.25, 0.75"/><bsdf type="diffuse"/><bsdf type="conductor"/></bsdf>)")["weights"] ==
          Json::parse("[0.25, 0.75]"));
}

TEST_CASE("parameters of the wrong type are refused, or left for the loader to refuse") {
    const XmlScene xml;
    const auto texture = [&](const std::string& content) { return entry(xml.read("<texture type=\"bitmap\" id=\"t\">" + content + "</texture>", "0.5.0"), "t"); };
    CHECK(texture(R"(<float name="filterType" value="1"/>)")["filter_type"] == 1.0);
    CHECK(texture(R"(<integer name="wrapModeU" value="1"/><integer name="wrapModeV" value="1"/>)")["wrap_mode_u"] == 1);
    const std::string relief = R"(<bsdf type="bumpmap" id="b"><string name="scale" value="x"/><texture type="scale"><texture type="bitmap"/></texture></bsdf>)";
    CHECK(entry(xml.read(relief, "0.5.0"), "b")["scale"] == "x");
    CHECK(xml.complaint(R"(<texture type="irregular"><float name="values" value="1"/></texture>)").has("needs two or more values at"));
    CHECK(errorOf([&] { xml.read(R"(<bsdf type="regular"/>)", "3.0.0", {.definitions = {}, .lenient = true}); }).has("needs two or more values at"));
    CHECK(xml.complaint(R"(<bsdf type="diffuse"><spectrum name="a" filename="none.spd"/></bsdf>)").has("there is no file \"none.spd\" at"));
    CHECK(xml.complaint("<bsdf type=\"diffuse\" id=\"\xff\"/>").has("the attribute \"id\" is not UTF-8 at"));
}

TEST_CASE("definitions that double each time end") {
    std::string doubling = R"(<default name="a0" value="aaaaaaaaaaaaaaaa"/>)";
    for (int i = 1; i < 60; ++i) doubling += fmt::format(R"(<default name="a{0}_" value="$a{1}$a{1}"/>)", i, i == 1 ? "0" : fmt::format("{}_", i - 1));
    CHECK(XmlScene{}.complaint(doubling).has("is longer than 1048576 bytes at"));
}

TEST_CASE("files that include others, in folders of their own") {
    const XmlScene xml;
    std::filesystem::create_directories(xml.folder.path / "parts");
    xml.folder.write("parts/ball.obj", "");
    xml.folder.write("parts/more.xml", R"(<scene version="0.6.0"><shape type="obj" id="x"><string name="filename" value="ball.obj"/>
        <transform name="toWorld"><translate x="1"/></transform></shape><include filename="bsdf.xml"/></scene>)");
    xml.folder.write("parts/bsdf.xml", R"(<bsdf version="3.0.0" type="diffuse" id="b"/>)");
    const auto document = xml.read(R"(<include filename="parts/more.xml"/><shape type="obj" id="y"><string name="filename" value="other.obj"/></shape>)");
    CHECK(document.json()["x"]["filename"] == "parts/ball.obj");
    CHECK(document.json()["x"].contains("to_world"));
    CHECK(document.json()["b"]["type"] == "diffuse");
    CHECK(document.json()["y"]["filename"] == "other.obj");
    CHECK(document.root().at("x").at("filename").where().find("more.xml:1:49 (/x/filename)") != std::string::npos);

    xml.folder.write("loop.xml", R"(<scene version="3.0.0"><include filename="loop.xml"/></scene>)");
    CHECK(xml.complaint(R"(<include filename="loop.xml"/>)").has("\"loop.xml\" includes itself at"));
    for (int i = 0; i < 20; ++i) xml.folder.write(fmt::format("chain{}.xml", i), fmt::format(R"(<scene version="3.0.0"><include filename="chain{}.xml"/></scene>)", i + 1));
    CHECK(xml.complaint(R"(<include filename="chain0.xml"/>)").has("include each other deeper than 15"));
    CHECK(xml.complaint("<include filename=\"" + std::string(5000, 'a') + "\"/>").has("cannot be found"));
    CHECK(xml.complaint(R"(<include filename="none.xml"/>)").has("there is no file \"none.xml\" at"));
    CHECK(xml.complaint(R"(<include filename="../up.xml"/>)").has("leaves the folder"));
    CHECK(xml.complaint(R"(<include filename="/etc/passwd"/>)").has("leaves the folder"));
}

TEST_CASE("mistakes are named with their place") {
    const XmlScene xml;
    const auto expect = [&](const std::string& content, const std::string& message, const std::string& place) {
        const Complaint complaint = xml.complaint(content);
        INFO(complaint.message);
        CHECK(complaint.code == ExitCode::InvalidConfig);
        CHECK(complaint.has(message));
        CHECK(complaint.has("scene.xml:" + place));
    };
    expect(R"(<shape type="sphere"><flaot name="radius" value="1"/></shape>)", "did you mean \"float\"", "2:22");
    expect(R"(<shape type="sphere"><float name="radius" value="1x"/></shape>)", "expected a number, found \"1x\"", "2:22");
    expect(R"(<shape type="sphere"><float value="1"/></shape>)", "<float> has no name", "2:22");
    expect(R"(<shape type="sphere"><float name="radius"/></shape>)", "no attribute \"value\"", "2:22");
    expect(R"(<shape type="sphere"><integer name="n" value="1.5"/></shape>)", "a whole number", "2:22");
    expect(R"(<shape type="sphere"><boolean name="n" value="yes"/></shape>)", "\"true\" or \"false\"", "2:22");
    expect(R"(<shape type="sphere"><point name="n" x="1" y="2"/></shape>)", "no attribute \"z\"", "2:22");
    expect(R"(<shape type="sphere"><rgb name="n" value="1 2"/></shape>)", "one or three numbers", "2:22");
    expect(R"(<shape type="sphere"><spectrum name="n" value="500:1"/></shape>)", "wavelengths and values", "2:22");
    expect(R"(<shape type="sphere"><transform name="to_world"><rotat angle="1"/></transform></shape>)", "did you mean \"rotate\"", "2:22");
    expect(R"(<shape type="sphere"><float name="radius" value="1"/><float name="radius" value="2"/></shape>)", "stands twice", "2:54");
    expect(R"(<shape/>)", "<shape> has no type", "2:1");
    expect(R"(<shape type="sphere" radius="2"/>)", "attribute \"radius\"", "2:1");
    expect("<shape type=\"sphere\">", "is no XML", "3:");

    xml.folder.write("scene.xml", "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><emitter type=\"point\"/>\n <shape type=\"spher\"/></scene>");
    const Complaint unknown = errorOf([&] { SceneDescription::fromFile(xml.folder.path / "scene.xml").build(); });
    CHECK(unknown.has("did you mean \"sphere\""));
    CHECK(unknown.has("scene.xml:2:2 (/shape/type)"));
}

TEST_CASE("lenient reading shows what it replaced and says so") {
    const XmlScene xml;
    const auto document = xml.read(R"(<sensor type="perspective"/><emitter type="point"/><emitter type="moon"/>
        <medium type="fog"/><shape type="hair"/>
        <shape type="sphere" id="s"><bsdf type="velvet"><float name="nap" value="1"/></bsdf></shape>
        <shape type="sphere" id="t"><bsdf type="diffuse"><texture name="reflectance" type="marble"/></bsdf></shape>)", "3.0.0", {.definitions = {}, .lenient = true});
    const Scene scene = SceneDescription::fromNode(document.root(), xml.folder.path).build();
    CHECK(document.json()["s"]["bsdf"] == Json::parse(R"({"type": "diffuse", "reflectance": [1, 0, 1]})"));
    CHECK(document.json()["t"]["bsdf"]["reflectance"] == Json::parse("[1, 0, 1]"));
    CHECK(scene.shapes.size() == 2);
    CHECK(scene.emitters.size() == 1);
    REQUIRE(scene.substitutions.size() == 5);
    CHECK(scene.substitutions[3].find("the bsdf \"velvet\" at") != std::string::npos);
    CHECK(scene.substitutions[3].find("scene.xml:4:37 is not known: magenta takes its place") != std::string::npos);
}

TEST_CASE("deep nesting, truncation and garbage are refused or read, never worse") {
    const XmlScene xml;
    std::string deep;
    for (int i = 0; i < 100'000; ++i) deep += "<bsdf type=\"twosided\">";
    for (int i = 0; i < 100'000; ++i) deep += "</bsdf>";
    CHECK(xml.complaint(deep).has("nested deeper than 64"));

    const std::string good = R"(<scene version="3.0.0"><default name="r" value="2"/><shape type="sphere" id="s"><float name="radius" value="$r"/>
        <transform name="to_world"><lookat origin="0 0 1" target="0 0 0" up="0 1 0"/></transform><ref id="b"/></shape>
        <bsdf type="twosided"><bsdf type="diffuse" id="b"><spectrum name="reflectance" value="400:1 500:2"/></bsdf></bsdf></scene>)";
    size_t read = 0;
    const auto attempt = [&](const std::string& text) {
        xml.folder.write("scene.xml", text);
        try {
            readMitsubaXml(xml.folder.path / "scene.xml");
            ++read;
        } catch (const Error& error) {
            REQUIRE(error.code() == ExitCode::InvalidConfig);
        }
    };
    for (size_t n = 0; n < good.size(); n += 3) attempt(good.substr(0, n));
    CHECK(read == 0);
    for (size_t i = 0; i < good.size(); ++i) {
        std::string broken = good;
        broken[i] = char(i * 37 + 1);
        attempt(broken);
    }
    attempt(good);
    CHECK(read > 0);
}
