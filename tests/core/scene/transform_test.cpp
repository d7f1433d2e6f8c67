#include "core/scene/loading/transform.h"

#include "core/base/error.h"
#include "tests/support/catch.h"
#include "tests/support/error_of.h"

using namespace ulam;

namespace {

Matrix4 parse(const std::string& text) {
    return parseTransform(JsonDocument::fromText(text, "t.json").root());
}

Vec3d apply(const Matrix4& m, const Vec3d& p) {
    Vec3d out;
    m.multVecMatrix(p, out);
    return out;
}

bool near(const Vec3d& a, const Vec3d& b) {
    return (a - b).length() < 1e-12;
}

std::string complaintAbout(const std::string& text) {
    const Complaint complaint = errorOf([&] { parse(text); });
    INFO(text << ": " << complaint.message);
    CHECK(complaint.code == ExitCode::InvalidConfig);
    return complaint.message;
}

}  // namespace

TEST_CASE("a matrix is row-major and acts on columns") {
    const Vec3d p(1, 10, 100);
    const Vec3d expected(1 * 2 + 3, 100 * -1.0 + 4, 10 + 5);
    CHECK(near(apply(parse("[2,0,0,3, 0,0,-1,4, 0,1,0,5, 0,0,0,1]"), p), expected));
    CHECK(near(apply(parse("[[2,0,0,3],[0,0,-1,4],[0,1,0,5],[0,0,0,1]]"), p), expected));
}

TEST_CASE("steps apply first to last") {
    CHECK(near(apply(parse(R"([{"type":"scale","value":2},{"type":"translate","value":[1,0,0]}])"), {1, 1, 1}),
               {3, 2, 2}));
    CHECK(near(apply(parse(R"([{"type":"translate","value":[1,0,0]},{"type":"scale","value":[2,3,4]}])"), {1, 1, 1}),
               {4, 3, 4}));
    CHECK(near(apply(parse(R"([{"type":"rotate","axis":[0,0,2],"angle":90}])"), {1, 0, 0}), {0, 1, 0}));
    CHECK(near(apply(parse(R"({"type":"translate","value":[1,2,3]})"), {0, 0, 0}), {1, 2, 3}));
}

TEST_CASE("lookat has x to the left, y up and z forward") {
    const Matrix4 m = parse(R"([{"type":"lookat","origin":[1,2,3],"target":[1,2,8],"up":[0,3,0]}])");
    CHECK(near(apply(m, {0, 0, 0}), {1, 2, 3}));
    CHECK(near(apply(m, {0, 0, 1}), {1, 2, 4}));
    CHECK(near(apply(m, {0, 1, 0}), {1, 3, 3}));
    CHECK(near(apply(m, {1, 0, 0}), {2, 2, 3}));
    CHECK(uniformScale(m).value() == Approx(1));
}

TEST_CASE("uniform scale is recognised, with its sign") {
    CHECK(uniformScale(parse(R"([{"type":"scale","value":3},{"type":"rotate","axis":[1,2,3],"angle":40}])")).value() ==
          Approx(3));
    CHECK(uniformScale(parse(R"([{"type":"scale","value":[1,-1,1]}])")).value() == Approx(-1));
    CHECK_FALSE(uniformScale(parse(R"([{"type":"scale","value":[1,1,1.01]}])")));
    CHECK_FALSE(uniformScale(parse("[1,0.1,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]")));
}

TEST_CASE("what is no transformation is refused") {
    CHECK(mentions(complaintAbout("[1,2,3]"), "16 numbers"));
    CHECK(mentions(complaintAbout("[[1,2,3,4]]"), "16 numbers"));
    CHECK(mentions(complaintAbout("\"identity\""), "16 numbers"));
    CHECK(mentions(complaintAbout("[]"), "16 numbers"));
    CHECK(mentions(complaintAbout(R"([{"type":"rotat","axis":[0,0,1],"angle":1}])"), "\"rotate\""));
    CHECK(mentions(complaintAbout(R"([{"type":"rotate","axis":[0,0,0],"angle":1}])"), "axis"));
    CHECK(mentions(complaintAbout(R"([{"type":"rotate","axis":[0,0,1],"angel":1}])"), "\"angle\""));
    CHECK(mentions(complaintAbout(R"([{"type":"scale","value":[1,1,0]}])"), "not invertible"));
    CHECK(mentions(complaintAbout("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]"), "last row"));
    CHECK(mentions(complaintAbout(R"([{"type":"scale","value":1e200},{"type":"scale","value":1e200}])"), "not finite"));
    CHECK(mentions(complaintAbout(R"([{"type":"lookat","origin":[0,0,0],"target":[0,1,0],"up":[0,1,0]}])"), "up"));
    CHECK(mentions(complaintAbout(R"([{"type":"lookat","origin":[0,0,0],"target":[0,0,0],"up":[0,1,0]}])"), "target"));
}
