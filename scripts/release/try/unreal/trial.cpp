// SPDX-License-Identifier: MIT
// trial ASSET: the plugin's component and animation node on a skeletal mesh with the asset's bones, as an importer of
// Unreal makes it: Y turned around, a hundred units for one of the file. An arm goes into the body, and the node brings
// it out.
#include <spherechain/spherechain.h>

#include "AnimNode_SpherechainResponse.h"
#include "CoreMinimal.h"
#include "SpherechainComponent.h"

#include <cstdlib>

constexpr float kUnit = 100;

static void require(bool holds, const char* what) {
  if (holds) return;
  std::printf("FAILED: %s\n", what);
  for (const std::string& line : stub_logged()) std::printf("  %s\n", line.c_str());
  std::exit(1);
}

static bool logged(const char* text) {
  const bool is_there = stub_logged().size() == 1 && stub_logged()[0].find(text) != std::string::npos;
  if (is_there) stub_logged().clear();
  return is_there;
}

// The asset's bones are not turned at rest, so an inverse bind matrix is a translation.
static FVector place_of(const spherechain::Bone& bone) {
  return {-kUnit * bone.inverse_bind[3], kUnit * bone.inverse_bind[7], -kUnit * bone.inverse_bind[11]};
}

static USkeletalMesh make_mesh(const spherechain::Model& model) {
  USkeletalMesh mesh;
  const int32 count = static_cast<int32>(model.info().bone_count);
  for (int32 i = 0; i < count; ++i) {
    const spherechain::Bone bone = sc_asset_bone(&model.asset(), static_cast<size_t>(i));
    std::string name = std::string("armature:") + bone.name;
    name[9] = static_cast<char>(name[9] - 32);  // Unreal does not keep the case
    mesh.skeleton.names.Add({name});
    mesh.skeleton.parents.Add(-1);
    FTransform inverse;
    inverse.translation = place_of(bone) * -1;
    mesh.inverse_binds.Add(FMatrix44f(inverse.ToMatrixWithScale()));
  }
  for (uint32_t p = 0; p < model.part_count(); ++p) {
    const spherechain::BodyPart part = model.part(p);
    const int parent = part.parent < 0 ? -1 : model.part(static_cast<uint32_t>(part.parent)).bone;
    if (part.bone >= 0 && parent != part.bone) mesh.skeleton.parents[part.bone] = parent;
  }
  for (int32 i = 0; i < count; ++i) {
    const int32 parent = mesh.skeleton.parents[i];
    const FVector own = place_of(sc_asset_bone(&model.asset(), static_cast<size_t>(i)));
    const FVector above = parent < 0 ? FVector() : place_of(sc_asset_bone(&model.asset(), static_cast<size_t>(parent)));
    FTransform local;
    local.translation = own + above * -1;
    mesh.skeleton.pose.Add(local);
  }
  return mesh;
}

static FQuat product(const FQuat& a, const FQuat& b) {
  return {a.W * b.X + a.X * b.W + a.Y * b.Z - a.Z * b.Y, a.W * b.Y - a.X * b.Z + a.Y * b.W + a.Z * b.X,
          a.W * b.Z + a.X * b.Y - a.Y * b.X + a.Z * b.W, a.W * b.W - a.X * b.X - a.Y * b.Y - a.Z * b.Z};
}

static FTransform in_component(const USkeletalMesh& mesh, const TArray<FTransform>& locals, int32 bone) {
  const int32 parent = mesh.skeleton.parents[bone];
  if (parent < 0) return locals[bone];
  const FTransform above = in_component(mesh, locals, parent);
  FTransform out;
  out.translation = above.TransformPosition(locals[bone].translation);
  out.rotation = product(above.rotation, locals[bone].rotation);
  return out;
}

static float deepest(USpherechainComponent& component, USkeletalMeshComponent& mesh, const TArray<FTransform>& locals) {
  mesh.bones.Reset();
  for (int32 i = 0; i < locals.Num(); ++i) mesh.bones.Add(in_component(*mesh.mesh, locals, i));
  component.TickComponent(1 / 30.0f, LEVELTICK_All, nullptr);
  float depth = 0;
  for (const FSpherechainPenetration& found : component.Penetrations) depth = std::max(depth, found.Depth);
  return depth;
}

int main(int argc, char** argv) {
  require(argc == 2, "trial ASSET");
  TArray<uint8> bytes;
  FFileHelper::LoadFileToArray(bytes, argv[1]);
  const spherechain::Model model(bytes.GetData(), static_cast<size_t>(bytes.Num()), nullptr, 0, SC_LAYOUT_UNSET);
  require(static_cast<bool>(model), model.message());
  USkeletalMesh mesh = make_mesh(model);
  USkeletalMeshComponent skeletal;
  skeletal.mesh = &mesh;
  skeletal.to_world.translation = {1e7, 0, 20};
  AActor actor;

  USpherechainComponent component;
  component.owner = &actor;
  component.BeginPlay();
  require(logged("no skeletal mesh"), "an actor without a mesh");
  actor.component = &skeletal;
  component.Settings.Asset = "/no/such/file.sphc";
  component.BeginPlay();
  require(logged("/no/such/file.sphc cannot be read"), "a file that is not there");
  component.Settings.Asset = argv[1];
  component.Settings.SourceUnit = kUnit;
  component.Settings.MirroredAxis = EAxis::X;
  component.BeginPlay();
  require(logged("inverse bind"), "another axis is refused");
  component.Settings.MirroredAxis = EAxis::Y;
  component.BeginPlay();
  require(stub_logged().empty() && component.before == &skeletal, "the component binds, and ticks after the mesh");

  TArray<FTransform> locals = mesh.skeleton.pose;
  require(deepest(component, skeletal, locals) == 0, "there is no fault at rest");
  int32 arm = -1, upper = 0;
  for (int32 i = 0; i < locals.Num(); ++i) {
    if (mesh.skeleton.names[i].text == "armature:Left_shoulder") arm = i;
  }
  require(arm >= 0, "the trial's asset has a left_shoulder");
  float depth = 0;
  const float enough = 0.01f * kUnit * model.info().height;
  for (float angle = 0; angle < 2 && depth < enough; angle += 0.05f) {
    for (upper = -1; upper <= 1 && depth < enough; upper += 2) {
      const float sin = upper * std::sin(angle / 2);  // about no axis of the file, so a wrong mirror shows
      locals[arm].rotation = {0.36 * sin, 0.48 * sin, 0.8 * sin, std::cos(angle / 2)};
      depth = deepest(component, skeletal, locals);
    }
  }
  require(depth > 0 && stub_drawn > 0, "the arm goes in, and it is drawn");
  const FSpherechainPenetration first = component.Penetrations[0];
  std::printf("%s in %s: %.1f %% of the height; move %s\n", *first.Part, *first.Other,
              100 * first.Depth / (kUnit * model.info().height), *first.Bone.ToString());
  require(std::abs(first.Position.X - 1e7) < kUnit * model.info().height, "a position is the world's");
  require(first.Bone.ToString().Len() > 9, "the bone has a name");
  // The animation node, with a level of detail that leaves out the last bone.
  FAnimNode_SpherechainResponse node;
  node.Settings = component.Settings;
  UAnimInstance instance;
  instance.component = &skeletal;
  node.OnInitializeAnimInstance(nullptr, &instance);
  node.Initialize_AnyThread({});
  FBoneContainer container;
  FCompactPose animated;
  animated.container = &container;
  for (int32 i = 0; i + 1 < locals.Num(); ++i) {
    container.mesh_of_compact.Add(i);
    animated.bones.Add(locals[i]);
  }
  node.Source.source = &animated;
  FPoseContext output;
  const auto play = [&](int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      node.Update_AnyThread({1 / 30.0f});
      node.Evaluate_AnyThread(output);
    }
  };
  animated.bones[arm].rotation = {};  // at rest, then in the body: from there on it turns with time
  play(1);
  animated.bones[arm].rotation = locals[arm].rotation;
  play(40);
  TArray<FTransform> corrected = locals;
  for (int32 i = 0; i < output.Pose.bones.Num(); ++i) corrected[i] = output.Pose.bones[i];
  const float left = deepest(component, skeletal, corrected);
  std::printf("after the response: %.1f %%\n", 100 * left / (kUnit * model.info().height));
  require(left < 0.2f * depth, "the node brings the arm out");
  const FQuat &before = locals[arm].rotation, &after = corrected[arm].rotation;
  const double same = before.X * after.X + before.Y * after.Y + before.Z * after.Z + before.W * after.W;
  require(std::abs(same) > std::cos(0.15), "the arm turns by less than 0.3");
  node.Alpha = 0;
  play(40);
  require(output.Pose.bones[arm].rotation.Z == locals[arm].rotation.Z, "with Alpha 0 the pose is as animated");
  require(stub_logged().empty(), "nothing else is logged");
  return 0;
}
