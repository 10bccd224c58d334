// SPDX-License-Identifier: MIT
// The types of Unreal Engine 5 that the plugin uses, written from their documentation, with one bone hierarchy instead
// of a world. All of the engine's headers that the plugin includes lead here. Matrices are for row vectors: v M, the
// translation in row 3.
#pragma once

#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#define TEXT(x) x
#define UTF8_TO_TCHAR(x) x
#define UCLASS(...)
#define USTRUCT(...)
#define UPROPERTY(...)
#define GENERATED_BODY()
#define SPHERECHAIN_API
#define ENABLE_DRAW_DEBUG 1
#ifndef PLATFORM_WINDOWS
#define PLATFORM_WINDOWS 0
#endif
#define DECLARE_LOG_CATEGORY_EXTERN(name, ...) \
  struct FLog##name {};                        \
  extern FLog##name name
#define DEFINE_LOG_CATEGORY(name) FLog##name name
#define UE_LOG(category, verbosity, ...) ((void)category, stub_log(__VA_ARGS__))
#define IMPLEMENT_MODULE(type, name) type stub_module_##name;

using TCHAR = char;
using ANSICHAR = char;
using int32 = int32_t;
using uint8 = uint8_t;
using uint32 = uint32_t;
using SIZE_T = std::size_t;

inline std::vector<std::string>& stub_logged() {
  static std::vector<std::string> lines;
  return lines;
}
inline void stub_log(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  stub_logged().push_back(text);
}

struct FString {
  std::string text;
  FString() = default;
  FString(const char* t) : text(t) {}
  const char* operator*() const { return text.c_str(); }
  int32 Len() const { return static_cast<int32>(text.size()); }
  TCHAR operator[](int32 i) const { return text[static_cast<std::size_t>(i)]; }
  void Empty() { text.clear(); }
  void AppendChar(TCHAR c) { text += c; }
  FString operator+(const TCHAR* more) const { return FString((text + more).c_str()); }
  bool operator<(const FString& other) const { return text < other.text; }
};
struct FChar {
  static bool IsAlnum(TCHAR c) { return (c >= '0' && c <= '9') || (ToLower(c) >= 'a' && ToLower(c) <= 'z'); }
  static TCHAR ToLower(TCHAR c) { return c >= 'A' && c <= 'Z' ? static_cast<TCHAR>(c + 32) : c; }
};
struct FTCHARToUTF8 {
  std::string text;
  explicit FTCHARToUTF8(const TCHAR* t) : text(t) {}
  const char* Get() const { return text.c_str(); }
  int32 Length() const { return static_cast<int32>(text.size()); }
};
struct FName {
  std::string text;
  FString ToString() const { return FString(text.c_str()); }
};
struct FText {
  FString string;
  static FText FromString(const FString& s) { return {s}; }
};

template <typename T>
struct TArray {
  std::vector<T> items;
  int32 Num() const { return static_cast<int32>(items.size()); }
  T* GetData() { return items.data(); }
  const T* GetData() const { return items.data(); }
  T& operator[](int32 i) { return items.at(static_cast<std::size_t>(i)); }
  const T& operator[](int32 i) const { return items.at(static_cast<std::size_t>(i)); }
  void Add(const T& item) { items.push_back(item); }
  void Append(const T* from, int32 count) { items.insert(items.end(), from, from + count); }
  T& AddDefaulted_GetRef() { return items.emplace_back(); }
  void SetNumZeroed(int32 count) { items.assign(static_cast<std::size_t>(count), T{}); }
  void Reset() { items.clear(); }
  bool IsValidIndex(int32 i) const { return i >= 0 && i < Num(); }
  auto begin() const { return items.begin(); }
  auto end() const { return items.end(); }
};
template <typename K, typename V>
struct TMap {
  std::map<K, V> entries;
  void Add(const K& key, const V& value) { entries[key] = value; }
  const V* Find(const K& key) const { return entries.count(key) == 0 ? nullptr : &entries.at(key); }
};
template <typename T>
struct TSharedPtr : std::shared_ptr<T> {
  using std::shared_ptr<T>::shared_ptr;
  TSharedPtr(std::shared_ptr<T> other) : std::shared_ptr<T>(std::move(other)) {}
  void Reset() { this->reset(); }
};
template <typename T>
TSharedPtr<T> MakeShared() {
  return TSharedPtr<T>(std::make_shared<T>());
}
template <typename T>
struct TObjectPtr {
  T* object = nullptr;
  TObjectPtr& operator=(T* o) {
    object = o;
    return *this;
  }
  T* operator->() const { return object; }
  operator T*() const { return object; }
};
template <typename T>
struct TEnumAsByte {
  uint8 value;
  TEnumAsByte(T v) : value(static_cast<uint8>(v)) {}
  T GetValue() const { return static_cast<T>(value); }
};
namespace EAxis {
enum Type { None, X, Y, Z };
}
struct FMath {
  static int32 Min(int32 a, int32 b) { return a < b ? a : b; }
  static float Clamp(float x, float low, float high) { return x < low ? low : x > high ? high : x; }
};
struct FMemory {
  static int32 Memcmp(const void* a, const void* b, SIZE_T size) { return std::memcmp(a, b, size); }
};

struct FVector {
  double X = 0, Y = 0, Z = 0;
  static const FVector ZeroVector;
  FVector() = default;
  FVector(double x, double y, double z) : X(x), Y(y), Z(z) {}
  FVector operator*(double s) const { return {X * s, Y * s, Z * s}; }
  FVector operator+(const FVector& v) const { return {X + v.X, Y + v.Y, Z + v.Z}; }
};
inline const FVector FVector::ZeroVector{};
struct FQuat {
  double X = 0, Y = 0, Z = 0, W = 1;
  FQuat() = default;
  FQuat(double x, double y, double z, double w) : X(x), Y(y), Z(z), W(w) {}
};
template <typename T>
struct TMatrix {
  T M[4][4] = {};
  TMatrix() = default;
  template <typename O>
  explicit TMatrix(const TMatrix<O>& from) {
    for (int i = 0; i < 16; ++i) (&M[0][0])[i] = static_cast<T>((&from.M[0][0])[i]);
  }
  TMatrix operator*(const TMatrix& other) const {
    TMatrix out;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 4; ++k) out.M[i][j] += M[i][k] * other.M[k][j];
      }
    }
    return out;
  }
};
using FMatrix = TMatrix<double>;
using FMatrix44f = TMatrix<float>;
struct FTransform {
  FQuat rotation;
  FVector translation, scale{1, 1, 1};
  FVector GetTranslation() const { return translation; }
  FVector GetScale3D() const { return scale; }
  FQuat GetRotation() const { return rotation; }
  void SetRotation(const FQuat& q) { rotation = q; }
  FMatrix ToMatrixWithScale() const {
    const FQuat& q = rotation;
    FMatrix out;
    const double rows[3][3] = {
        {1 - 2 * (q.Y * q.Y + q.Z * q.Z), 2 * (q.X * q.Y + q.W * q.Z), 2 * (q.X * q.Z - q.W * q.Y)},
        {2 * (q.X * q.Y - q.W * q.Z), 1 - 2 * (q.X * q.X + q.Z * q.Z), 2 * (q.Y * q.Z + q.W * q.X)},
        {2 * (q.X * q.Z + q.W * q.Y), 2 * (q.Y * q.Z - q.W * q.X), 1 - 2 * (q.X * q.X + q.Y * q.Y)}};
    const double s[3] = {scale.X, scale.Y, scale.Z};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) out.M[i][j] = s[i] * rows[i][j];
    }
    out.M[3][0] = translation.X, out.M[3][1] = translation.Y, out.M[3][2] = translation.Z, out.M[3][3] = 1;
    return out;
  }
  FVector TransformVector(const FVector& v) const {
    const FMatrix m = ToMatrixWithScale();
    return {v.X * m.M[0][0] + v.Y * m.M[1][0] + v.Z * m.M[2][0], v.X * m.M[0][1] + v.Y * m.M[1][1] + v.Z * m.M[2][1],
            v.X * m.M[0][2] + v.Y * m.M[1][2] + v.Z * m.M[2][2]};
  }
  FVector TransformPosition(const FVector& p) const { return TransformVector(p) + translation; }
};

struct FReferenceSkeleton {
  TArray<FName> names;
  TArray<int32> parents;
  TArray<FTransform> pose;
  int32 GetRawBoneNum() const { return names.Num(); }
  FName GetBoneName(int32 i) const { return names[i]; }
  int32 GetParentIndex(int32 i) const { return parents[i]; }
  const TArray<FTransform>& GetRefBonePose() const { return pose; }
};
struct USkeletalMesh {
  FReferenceSkeleton skeleton;
  TArray<FMatrix44f> inverse_binds;
  const FReferenceSkeleton& GetRefSkeleton() const { return skeleton; }
  const TArray<FMatrix44f>& GetRefBasesInvMatrix() const { return inverse_binds; }
};
struct UWorld {};
struct UActorComponent;
struct USkeletalMeshComponent {
  USkeletalMesh* mesh = nullptr;
  TArray<FTransform> bones;
  FTransform to_world;
  USkeletalMesh* GetSkeletalMeshAsset() const { return mesh; }
  const TArray<FTransform>& GetComponentSpaceTransforms() const { return bones; }
  FTransform GetComponentTransform() const { return to_world; }
  FName GetBoneName(int32 i) const { return mesh->skeleton.names[i]; }
};
struct AActor {
  USkeletalMeshComponent* component = nullptr;
  template <typename T>
  T* FindComponentByClass() const {
    return component;
  }
  FString GetName() const { return "actor"; }
};
enum ELevelTick { LEVELTICK_All };
enum ETickingGroup { TG_PostPhysics };
struct FActorComponentTickFunction {
  bool bCanEverTick = false;
  ETickingGroup TickGroup{};
};
struct UActorComponent {
  using Super = UActorComponent;
  virtual ~UActorComponent() = default;
  FActorComponentTickFunction PrimaryComponentTick;
  AActor* owner = nullptr;
  void* before = nullptr;
  AActor* GetOwner() const { return owner; }
  UWorld* GetWorld() const { return nullptr; }
  virtual void BeginPlay() {}
  virtual void TickComponent(float, ELevelTick, FActorComponentTickFunction*) {}
  void AddTickPrerequisiteComponent(USkeletalMeshComponent* component) { before = component; }
};
struct FColor {
  static const FColor Red;
};
inline const FColor FColor::Red{};
inline int stub_drawn = 0;
inline void DrawDebugPoint(const UWorld*, const FVector&, float, const FColor&) { ++stub_drawn; }
inline void DrawDebugLine(const UWorld*, const FVector&, const FVector&, const FColor&) { ++stub_drawn; }

struct FPaths {
  static bool IsRelative(const FString& path) { return path.Len() == 0 || path[0] != '/'; }
  static FString ProjectContentDir() { return "content"; }
  static FString Combine(const FString& a, const FString& b) { return FString((a.text + "/" + b.text).c_str()); }
};
struct FFileHelper {
  static bool LoadFileToArray(TArray<uint8>& to, const TCHAR* path) {
    std::ifstream file(path, std::ios::binary);
    to.items.assign(std::istreambuf_iterator<char>(file), {});
    return static_cast<bool>(file);
  }
};
struct FPlatformProcess {
  static void* GetDllHandle(const TCHAR*) { return nullptr; }
  static void FreeDllHandle(void*) {}
};
struct IModuleInterface {
  virtual ~IModuleInterface() = default;
  virtual void StartupModule() {}
  virtual void ShutdownModule() {}
};
struct IPlugin {
  FString GetBaseDir() const { return "plugin"; }
};
struct IPluginManager {
  static IPluginManager Get() { return {}; }
  TSharedPtr<IPlugin> FindPlugin(const TCHAR*) const { return MakeShared<IPlugin>(); }
};
struct FDefaultModuleImpl : IModuleInterface {};

// Animation: one pose goes through the node, without the bones that a level of detail leaves out.
struct FCompactPoseBoneIndex {
  int32 index;
};
struct FMeshPoseBoneIndex {
  int32 index;
  int32 GetInt() const { return index; }
};
struct FBoneContainer {
  TArray<int32> mesh_of_compact;
  FMeshPoseBoneIndex MakeMeshPoseIndex(FCompactPoseBoneIndex bone) const { return {mesh_of_compact[bone.index]}; }
};
struct FCompactPose {
  const FBoneContainer* container = nullptr;
  TArray<FTransform> bones;
  const FBoneContainer& GetBoneContainer() const { return *container; }
  std::vector<FCompactPoseBoneIndex> ForEachBoneIndex() const {
    std::vector<FCompactPoseBoneIndex> out;
    for (int32 i = 0; i < bones.Num(); ++i) out.push_back({i});
    return out;
  }
  FTransform& operator[](FCompactPoseBoneIndex bone) { return bones[bone.index]; }
};
struct FPoseContext {
  FCompactPose Pose;
};
struct FAnimationInitializeContext {};
struct FAnimationCacheBonesContext {};
struct FAnimationUpdateContext {
  float seconds = 0;
  float GetDeltaTime() const { return seconds; }
};
struct FAnimNode_Base;
struct FNodeDebugData {
  FString GetNodeName(FAnimNode_Base*) const { return "node"; }
  void AddDebugItem(const FString&) {}
};
struct FPoseLink {
  FCompactPose* source = nullptr;
  void Initialize(const FAnimationInitializeContext&) {}
  void CacheBones(const FAnimationCacheBonesContext&) {}
  void Update(const FAnimationUpdateContext&) {}
  void Evaluate(FPoseContext& out) { out.Pose = *source; }
  void GatherDebugData(FNodeDebugData&) {}
};
struct FAnimInstanceProxy {};
struct UAnimInstance {
  USkeletalMeshComponent* component = nullptr;
  USkeletalMeshComponent* GetSkelMeshComponent() const { return component; }
};
struct FExposedValueHandler {
  void Execute(const FAnimationUpdateContext&) const {}
};
struct FAnimNode_Base {
  FExposedValueHandler handler;
  virtual ~FAnimNode_Base() = default;
  const FExposedValueHandler& GetEvaluateGraphExposedInputs() const { return handler; }
  virtual bool NeedsOnInitializeAnimInstance() const { return false; }
  virtual void OnInitializeAnimInstance(const FAnimInstanceProxy*, const UAnimInstance*) {}
  virtual void Initialize_AnyThread(const FAnimationInitializeContext&) {}
  virtual void CacheBones_AnyThread(const FAnimationCacheBonesContext&) {}
  virtual void Update_AnyThread(const FAnimationUpdateContext&) {}
  virtual void Evaluate_AnyThread(FPoseContext&) {}
  virtual void GatherDebugData(FNodeDebugData&) {}
};
namespace ENodeTitleType {
enum Type { FullTitle };
}
struct UAnimGraphNode_Base {
  virtual ~UAnimGraphNode_Base() = default;
  virtual FText GetNodeTitle(ENodeTitleType::Type) const = 0;
  virtual FText GetTooltipText() const = 0;
  virtual FString GetNodeCategory() const = 0;
};
