// SPDX-License-Identifier: MIT
// A model, two bodies of it, and questions with arguments that no caller should pass.
#include <algorithm>
#include <limits>
#include <new>

#include "fuzz_case.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kModelWords = std::size_t{1} << 17;
constexpr std::size_t kStepSpheres = 16;               // of more, steps in many pieces take too long
constexpr std::size_t kMemory = std::size_t{1} << 27;  // bytes: more is refused
constexpr std::size_t kPrevious = 4;

// Memory that may run out, and all of which must come back.
struct Memory {
  std::size_t calls = 0, fails_at = ~std::size_t{0}, bytes = 0, blocks = 0;

  static void* allocate(void* user, std::size_t size, std::size_t alignment) {
    Memory& self = *static_cast<Memory*>(user);
    if (self.calls++ == self.fails_at || size > kMemory) return nullptr;
    self.bytes += size;
    ++self.blocks;
    return ::operator new(size, std::align_val_t(alignment), std::nothrow);
  }
  static void release(void* user, void* memory, std::size_t size, std::size_t alignment) {
    Memory& self = *static_cast<Memory*>(user);
    self.bytes -= size;
    --self.blocks;
    ::operator delete(memory, std::align_val_t(alignment));
  }
  sc_allocator allocator() { return {allocate, release, this}; }
};

// A pose, and what must be said of it; SC_OK: it is sound.
struct DrawnPose {
  Pose pose;
  bool is_spoiled = false;
};

bool draw_pose(Case& c, DrawnPose& out) {
  const bool with_bones = c.view().bone_count() > 0 && c.random.one_in(2);
  if (with_bones) draw_bones(c, out.pose);
  if ((!with_bones || c.random.one_in(4)) && !draw_vertices(c, out.pose)) return false;
  if (c.random.one_in(4)) {
    Ways ways;
    if (with_bones) {
      add_bone_ways(c, out.pose, ways);
    } else {
      add_vertex_ways(c, out.pose, ways);
    }
    const std::size_t before = c.spoiled;
    ways[c.random.up_to(ways.size() - 1)]();
    out.is_spoiled = c.spoiled > before;
  }
  return true;
}

enum class Question { kPenetrations, kContacts, kSpheres, kSteps, kGround, kBounds };

// A query, and the code with which the question must be refused; SC_OK: with none.
struct DrawnQuery {
  Query query;
  std::uint64_t added[4] = {};  // fields of a later version
  sc_code wanted = SC_OK;
};
static_assert(offsetof(DrawnQuery, added) == sizeof(Query));

class Asking {
 public:
  Asking(Case& c, const Model& model) : c_(c), model_(model) {
    filter_ = draw_filter(c);
    askew_pairs_ = filter_.ignored;
    put_askew(c, askew_pairs_);
    const std::size_t words = sc_part_words(&c.asset);
    auto* const ignored = c.arena.add<std::uint64_t>(words);
    for (std::size_t i = 0; i < words; ++i) ignored[i] = c.random.bits() & c.random.bits();
    ignored_parts_ = ignored;
    const std::size_t parts = c.view().part_count();
    auto* const pairs = c.arena.add<std::uint64_t>(parts * parts / 64 + 1);
    for (std::size_t i = 0; i <= parts * parts / 64; ++i) pairs[i] = c.random.bits();
    part_pairs_ = pairs;
    auto* const previous = c.arena.add<Penetration>(kPrevious);
    for (std::size_t i = 0; i < kPrevious; ++i) {
      previous[i] = {};
      previous[i].part = c.random.below(3);
      previous[i].other = c.random.one_in(4) ? SC_FLOOR : c.random.below(3);
      previous[i].kind = SC_CLASS_PENETRATION;
      fill_figures(c, &previous[i].direction.x, 3);
    }
    previous_ = previous;
  }

  // Asks once. `steps_fit`: the body was made for steps.
  void ask(Body& body, const Body* other, bool has_pose, bool other_has_pose, bool steps_fit) {
    const auto question = static_cast<Question>(c_.random.below(6));
    const bool of_two = other != nullptr && question < Question::kSpheres;
    DrawnQuery drawn = draw(question, of_two);
    const bool is_posed = has_pose && (!of_two || other_has_pose);
    find(body, of_two ? other : nullptr, drawn.query, question);
    const Status status = body.status();
    c_.expect(status == SC_OK || status.field != SC_FIELD_NONE, "a question's status without its field");
    (status == SC_OK ? c_.tally.ran : c_.tally.refused) += 1;
    if (!is_posed) {
      c_.expect(status == SC_NOT_OPEN, "an answer of a body without a pose");
    } else if (status == SC_NOT_IN_ASSET && (question == Question::kSpheres || skin_table_words(&c_.asset) == 0)) {
      return;  // the asset has no skin, or the pose has what its spheres do not follow
    } else if (drawn.wanted != SC_OK) {
      c_.expect(status == drawn.wanted, "a question with a wrong argument");
    } else if (question == Question::kSteps) {
      c_.expect(steps_fit || status == SC_TOO_SMALL || status == SC_NOT_OPEN, "steps of a body not made for them");
    } else {
      c_.expect(status == SC_OK, "a sound question is refused");
    }
  }

 private:
  // At most one thing is wrong with it.
  DrawnQuery draw(Question question, bool of_two) {
    DrawnQuery out;
    Query& query = out.query;
    Random& random = c_.random;
    query.scope = static_cast<Scope>(random.below(4));
    query.full = random.one_in(2) ? 1 : 0;
    query.classes = random.one_in(2) ? static_cast<std::uint32_t>(random.bits()) | 1U << random.below(6) : 0;
    query.limit = random.one_in(3) ? random.below(4) : random.one_in(4) ? ~std::size_t{0} : 0;
    query.radius = static_cast<Radius>(random.below(2));
    query.target = draw_target(c_);
    if (!of_two && random.one_in(3)) query.ignored_pairs = filter_.ignored;
    if (of_two && random.one_in(3)) query.ignored_parts = ignored_parts_;
    if (of_two && random.one_in(3)) query.ignored_parts_of_other = ignored_parts_;
    const bool is_of_parts = question == Question::kPenetrations || question == Question::kContacts;
    if (is_of_parts && random.one_in(3)) query.part_pairs = part_pairs_;
    if (random.one_in(3)) {
      query.previous = previous_;
      query.previous_count = kPrevious;
    }
    if (random.one_in(3)) query.tolerance = random.one_in(2) ? 0.01F : 0;
    const bool is_measured = question == Question::kPenetrations || question == Question::kGround;
    const bool is_of_itself = !of_two && (question == Question::kPenetrations || question == Question::kContacts);
    if (!random.one_in(4) || question == Question::kBounds) return out;
    switch (random.below(7)) {
      case 0:
        query.target = draw_none<Target>(c_, 8);
        out.wanted = question == Question::kSteps ? SC_OK : SC_UNSUPPORTED_TARGET;
        break;
      case 1:
        query.scope = draw_none<Scope>(c_, 4);
        out.wanted = is_of_itself ? SC_BAD_VALUE : SC_OK;
        break;
      case 2:
        if (!of_two) query.ignored_pairs = askew_pairs_;
        out.wanted = is_of_itself || (question == Question::kSpheres && !of_two) ? SC_MISALIGNED : SC_OK;
        break;
      case 3:
        query.rule = &bad_rule();
        out.wanted = is_measured ? SC_BAD_VALUE : SC_OK;
        break;
      case 4:
        query.radius = draw_none<Radius>(c_, 2);
        out.wanted = question == Question::kSpheres ? SC_BAD_VALUE : SC_OK;
        break;
      case 5:
        draw_size(out);
        break;
      default:
        query.tolerance = random.one_in(2) ? -1 : std::numeric_limits<float>::quiet_NaN();
        break;
    }
    return out;
  }

  // The size of an older, a later or no version; what is behind the struct.
  void draw_size(DrawnQuery& out) {
    Random& random = c_.random;
    const auto size = static_cast<std::uint32_t>(sizeof(Query));
    const std::uint32_t past = 8 * random.below(5), garbage[] = {1, 4, size - 1, 4097, 0x7FFFFFFF, 0xFFFFFFFF};
    out.query.struct_size = random.one_in(2) ? random.pick(garbage) : random.one_in(3) ? 0 : size + past;
    const std::uint32_t stated = out.query.struct_size, field = random.below(4);
    out.added[field] = random.one_in(2) ? random.bits() : 0;
    const bool is_known = stated == 0 || stated == size + past;
    out.wanted = is_known && (stated <= size + 8 * field || out.added[field] == 0) ? SC_OK : SC_BAD_VALUE;
  }

  void find(Body& body, const Body* other, const Query& query, Question question) {
    switch (question) {
      case Question::kPenetrations:
        return check(other == nullptr ? body.penetrations(query) : body.penetrations(*other, query), query, body);
      case Question::kContacts: {
        const Contacts found = other == nullptr ? body.contacts(query) : body.contacts(*other, query);
        for (const PartContact& contact : found) {
          c_.expect(is_part(contact.part_a) && is_part(contact.part_b) && contact.triangle_pairs > 0,
                    "a contact of no parts");
        }
        c_.expect(found.sphere_count <= found.sphere_total && found.triangle_count <= found.triangle_total &&
                      (body.status() == SC_OK || found.part_count + found.triangle_total == 0),
                  "the counts of contacts");
        return;
      }
      case Question::kSpheres: {
        const SpherePairs found = body.sphere_pairs(query);
        for (std::size_t i = 0; i < found.count; ++i) {
          c_.expect(found.pairs[i].a < found.pairs[i].b && found.pairs[i].b < c_.n, "a pair of no spheres");
        }
        c_.expect(found.count <= found.total, "the counts of pairs");
        return;
      }
      case Question::kSteps:
        for (const StepContact& contact : body.steps(query)) {
          c_.expect(is_part(contact.part_a) && is_part(contact.part_b) && contact.begin <= contact.end,
                    "a step of no parts");
        }
        return;
      case Question::kGround: {
        Ground ground{.up = {0, 1, 0}};
        fill_figures(c_, &ground.height, 1);
        if (!(ground.height > -1e9F && ground.height < 1e9F)) ground.height = 0;
        return check(body.below(ground, query), query, body);
      }
      case Question::kBounds: {
        Vec3 low{}, high{};
        body.bounds(low, high);
        return;
      }
    }
  }

  void check(const Penetrations& found, const Query& query, const Body& body) {
    const std::uint32_t classes = query.classes == 0
                                      ? 1U << SC_CLASS_DEEP_FOLD | 1U << SC_CLASS_PENETRATION | 1U << SC_CLASS_INSIDE
                                      : query.classes;
    for (const Penetration& one : found) {
      c_.expect(is_part(one.part) && (is_part(one.other) || one.other == SC_FLOOR), "a penetration of no part");
      c_.expect((classes >> one.kind & 1) != 0, "a class that was not asked for");
      c_.expect(one.joint == model_.part_joint(one.part), "the joint of another part");
    }
    c_.expect(found.count <= found.total && (query.limit == 0 || found.count <= query.limit), "the counts");
    c_.expect(body.status() == SC_OK || found.total == 0, "a refused question has an answer");
  }

  bool is_part(std::uint32_t part) const { return part < model_.part_count(); }

  Case& c_;
  const Model& model_;
  Filter filter_;
  const std::uint64_t* askew_pairs_ = nullptr;
  const std::uint64_t *ignored_parts_ = nullptr, *part_pairs_ = nullptr;
  const Penetration* previous_ = nullptr;
};

// True where it gave the body a pose.
bool give(Case& c, Body& body, const DrawnPose& drawn) {
  Transform place{{1, 2, 3}, {0, 0, 0.6F, 0.8F}, {1, 1, 1}};
  const std::uint32_t way = c.random.below(4);
  if (way == 0) place.scale.y = std::numeric_limits<float>::quiet_NaN();
  const Status status = way < 2 ? body.set_pose(drawn.pose, place) : body.set_pose(drawn.pose);
  c.expect(status == SC_OK || status.field != SC_FIELD_NONE, "a pose's status without its field");
  const bool is_sound = !drawn.is_spoiled && way != 0 && (way == 2 || way == 3 || drawn.pose.vertices == nullptr);
  c.expect(!is_sound || status == SC_OK, "a sound pose is refused");
  c.expect(way >= 2 || (way == 1 && drawn.pose.vertices == nullptr) || status != SC_OK, "a wrong place is taken");
  return status == SC_OK;
}

void ask_bodies(Case& c, const Model& model, Memory& memory) {
  const std::size_t rooms[] = {0, 1, 60, c.random.below(500)};
  BodyDef def;
  def.max_triangles = c.random.pick(rooms);
  def.max_penetrations = c.random.below(8);
  def.finds_steps = c.n <= kStepSpheres && c.random.one_in(2) ? 1 : 0;
  if (c.random.one_in(8)) def.max_triangles = c.random.one_in(2) ? ~std::size_t{0} : power_of_two(31) - 1;
  const std::size_t blocks = memory.blocks;
  Body body(model, def), other(model);
  const Status made = body.status();
  c.expect(
      static_cast<bool>(body) == (made == SC_OK) && (made == SC_OK || made == SC_NO_MEMORY || made == SC_BAD_VALUE),
      "a body's status");
  DrawnPose poses[3];
  for (DrawnPose& drawn : poses) {
    if (!draw_pose(c, drawn)) return;
  }
  Asking asking(c, model);
  c.arena.seal();
  if (!body || !other) {
    ++c.tally.refused;
    Penetrations none = body.penetrations();
    c.expect(body || (none.total == 0 && body.status() == SC_NULL), "an answer of no body");
    return;
  }
  const std::size_t calls = memory.calls;
  bool has_pose = false, other_has_pose = false;
  for (int i = 0; i < 12; ++i) {
    if (c.random.one_in(3)) has_pose = give(c, body, c.random.pick(poses));
    if (c.random.one_in(4)) other_has_pose = give(c, other, c.random.pick(poses));
    asking.ask(body, c.random.one_in(2) ? &other : nullptr, has_pose, other_has_pose, def.finds_steps != 0);
  }
  c.expect(memory.calls == calls && memory.blocks == blocks + 2, "a question allocates");
  c.expect(c.arena.kept_but({}), "a question writes into what it reads");
}

}  // namespace

void fuzz_model(Case& c) {
  if (!draw_asset(c) || skin_table_words(&c.asset) > kModelWords || skin_scratch_words(&c.asset) > kModelWords ||
      body_scratch_words(&c.asset, &c.asset) > kModelWords) {
    return;
  }
  const std::vector<Bone> joints = draw_engine_joints(c);
  Memory memory;
  const sc_allocator allocator = memory.allocator();
  ModelDef def;
  def.data = c.asset_bytes.data;
  def.size = c.asset_bytes.size;
  if (!joints.empty() && c.random.one_in(2)) {
    def.joints = joints.data();
    def.joint_count = joints.size();
    def.inverse_bind_layout = c.random.one_in(8) ? draw_none<MatrixLayout>(c, 5) : SC_ROWS_3X4;
  }
  def.allocator = &allocator;
  if (c.random.one_in(4)) memory.fails_at = c.random.below(6);
  const std::uint32_t way = c.random.below(24);
  if (way == 0) def.data = nullptr;
  if (way == 1) def.size -= std::min<std::size_t>(def.size, 1 + c.random.below(99));
  {
    const Model model(def);
    const Status made = model.status();
    c.expect(static_cast<bool>(model) == (made == SC_OK), "a model's status");
    c.expect(made == SC_OK || *model.message() != '\0', "a model's refusal without a reason");
    c.expect(way != 0 || made != SC_OK, "a model of no bytes");
    if (model) {
      for (const std::uint32_t of : {0U, c.random.below(1000), SC_NO_PART}) {
        const TriangleOwner owner = model.triangle(of);
        c.expect(owner.part == SC_NO_PART || owner.part < model.part_count(), "a triangle of no part");
        const std::uint32_t joint = model.part_joint(of);
        c.expect(joint == SC_NO_JOINT || def.joints == nullptr || joint < joints.size(), "a joint that does not exist");
      }
      ask_bodies(c, model, memory);
    } else {
      ++c.tally.refused;
    }
  }
  c.expect(memory.blocks == 0 && memory.bytes == 0, "memory that is not released");
}

}  // namespace spherechain::test
