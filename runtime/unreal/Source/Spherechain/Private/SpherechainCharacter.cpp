// SPDX-License-Identifier: MIT
#include "SpherechainCharacter.h"

#include "Engine/SkeletalMesh.h"
#include "Misc/FileHelper.h"
#include "Misc/Paths.h"
#include "ReferenceSkeleton.h"
#include "SpherechainLog.h"

namespace
{
// Unreal's names do not keep the case, and its importers drop namespaces and replace characters.
FString Canonical(const FString& Name)
{
	FString Out;
	for (int32 i = 0; i < Name.Len(); ++i)
	{
		const TCHAR C = Name[i];
		if (C == TEXT(':') || C == TEXT('|')) Out.Empty();
		else Out.AppendChar(FChar::IsAlnum(C) ? FChar::ToLower(C) : TEXT('_'));
	}
	return Out;
}

// Terminated, for C.
TArray<ANSICHAR> Utf8(const FString& Text)
{
	const FTCHARToUTF8 Converted(*Text);
	TArray<ANSICHAR> Out;
	Out.Append(reinterpret_cast<const ANSICHAR*>(Converted.Get()), Converted.Length());
	Out.Add('\0');
	return Out;
}

FString Text(const char* Utf8Text) { return FString(UTF8_TO_TCHAR(Utf8Text)); }
}  // namespace

TSharedPtr<FSpherechainCharacter> FSpherechainCharacter::Make(const FSpherechainSettings& Settings, const USkeletalMesh& Mesh)
{
	const FString File = FPaths::IsRelative(Settings.Asset) ? FPaths::Combine(FPaths::ProjectContentDir(), Settings.Asset) : Settings.Asset;
	TArray<uint8> Bytes;
	if (!FFileHelper::LoadFileToArray(Bytes, *File))
	{
		UE_LOG(LogSpherechain, Error, TEXT("%s cannot be read"), *File);
		return nullptr;
	}
	TSharedPtr<FSpherechainCharacter> Made = MakeShared<FSpherechainCharacter>();
	Made->Turned = static_cast<int32>(Settings.MirroredAxis.GetValue()) - 1;
	Made->Unit = Settings.SourceUnit;

	// The asset's own spelling of its bones' names: a model in the asset's order knows it.
	spherechain::ModelDef Def;
	Def.data = Bytes.GetData();
	Def.size = Bytes.Num();
	const spherechain::Model Plain(Def);
	if (!Plain)
	{
		UE_LOG(LogSpherechain, Error, TEXT("%s: %s"), *File, *Text(Plain.message()));
		return nullptr;
	}
	TMap<FString, FString> Spelling;
	for (SIZE_T i = 0; i < Plain.info().bone_count; ++i)
	{
		const FString Name = Text(sc_asset_bone(&Plain.asset(), i).name);
		Spelling.Add(Canonical(Name), Name);
	}

	const FReferenceSkeleton& Skeleton = Mesh.GetRefSkeleton();
	const TArray<FMatrix44f>& Binds = Mesh.GetRefBasesInvMatrix();
	const int32 Count = FMath::Min(Skeleton.GetRawBoneNum(), Binds.Num());  // virtual bones come after them
	TArray<TArray<ANSICHAR>> Names;
	TArray<float> Sources;
	Sources.SetNumZeroed(16 * Count);
	for (int32 i = 0; i < Count; ++i)
	{
		const FString Name = Skeleton.GetBoneName(i).ToString();
		const FString* const Own = Spelling.Find(Canonical(Name));
		Names.Add(Utf8(Own != nullptr ? *Own : Name));
		const int32 Parent = Skeleton.GetParentIndex(i);
		Made->Parents.Add(Parent < 0 ? SC_NO_JOINT : static_cast<uint32>(Parent));
		Made->InverseBinds.Add(Binds[i]);
		Made->ToSource(Binds[i], &Sources[16 * i]);
	}
	TArray<spherechain::Bone> Bones;
	Bones.SetNumZeroed(Count);
	for (int32 i = 0; i < Count; ++i)
	{
		Bones[i].name = Names[i].GetData();
		Bones[i].inverse_bind = &Sources[16 * i];
	}
	Def.joints = Bones.GetData();
	Def.joint_count = Count;
	Def.inverse_bind_layout = SC_COLUMNS_4X4;
	Made->Model = spherechain::Model(Def);
	if (!Made->Model)
	{
		UE_LOG(LogSpherechain, Error, TEXT("%s: %s"), *File, *Text(Made->Model.message()));
		return nullptr;
	}
	Made->Body = spherechain::Body(Made->Model);
	spherechain::ResponseDef ResponseDef;
	ResponseDef.parents = Made->Parents.GetData();
	ResponseDef.joint_count = Count;
	if (Made->Body) Made->Response = spherechain::Response(Made->Body, ResponseDef);
	if (!Made->Response)
	{
		const spherechain::Status Status = Made->Body ? Made->Response.status() : Made->Body.status();
		UE_LOG(LogSpherechain, Error, TEXT("%s: %s: %s"), *File, *Text(spherechain::field_name(Status)),
		       *Text(spherechain::code_text(Status)));
		return nullptr;
	}
	Made->Palette.SetNumZeroed(16 * Count);
	Made->Joints.SetNumZeroed(Count);
	return Made;
}

// F M F, with F the mirror, and lengths in the source's unit. Unreal's matrices are for row vectors: their floats in order are the
// columns of a matrix for column vectors.
void FSpherechainCharacter::ToSource(const FMatrix44f& From, float* To) const
{
	for (int32 Column = 0; Column < 4; ++Column)
	{
		for (int32 Row = 0; Row < 3; ++Row)
		{
			const float Value = Sign(Row) * From.M[Column][Row];
			To[4 * Column + Row] = Column == 3 ? Value / Unit : Value * Sign(Column);
		}
		To[4 * Column + 3] = Column == 3 ? 1.0f : 0.0f;
	}
}

bool FSpherechainCharacter::SetPose(const TArray<FTransform>& Bones)
{
	if (Bones.Num() < BoneCount()) return false;
	for (int32 i = 0; i < BoneCount(); ++i)
	{
		ToSource(InverseBinds[i] * FMatrix44f(Bones[i].ToMatrixWithScale()), &Palette[16 * i]);
	}
	spherechain::Pose Pose;
	Pose.bones = Palette.GetData();
	Pose.bone_count = BoneCount();
	Pose.bone_layout = SC_COLUMNS_4X4;
	return Body.set_pose(Pose) == SC_OK;
}

// A mirror of one axis keeps that component of a rotation's axis and turns the others.
spherechain::Transform FSpherechainCharacter::ToSource(const FTransform& Local) const
{
	const FVector T = Local.GetTranslation(), S = Local.GetScale3D();
	const FQuat Q = Local.GetRotation();
	const float All = Turned < 0 ? 1.0f : -1.0f;
	return {{Sign(0) * float(T.X) / Unit, Sign(1) * float(T.Y) / Unit, Sign(2) * float(T.Z) / Unit},
	        {All * Sign(0) * float(Q.X), All * Sign(1) * float(Q.Y), All * Sign(2) * float(Q.Z), float(Q.W)},
	        {float(S.X), float(S.Y), float(S.Z)}};
}

int32 FSpherechainCharacter::Respond(TArray<FTransform>& Locals, float Seconds, float Weakness)
{
	if (Locals.Num() < BoneCount()) return 0;
	for (int32 i = 0; i < BoneCount(); ++i) Joints[i] = ToSource(Locals[i]);
	spherechain::ResponseFrame Frame;
	Frame.joints = Joints.GetData();
	Frame.seconds = Seconds;
	Frame.weakness = Weakness;
	if (Response.respond(State, Frame) != SC_OK || Frame.turned == 0) return 0;
	const float All = Turned < 0 ? 1.0f : -1.0f;
	for (int32 i = 0; i < BoneCount(); ++i)
	{
		const float* const After = Joints[i].rotation;
		const spherechain::Transform Before = ToSource(Locals[i]);
		if (FMemory::Memcmp(Before.rotation, After, sizeof Before.rotation) == 0) continue;
		Locals[i].SetRotation(FQuat(All * Sign(0) * After[0], All * Sign(1) * After[1], All * Sign(2) * After[2], After[3]));
	}
	return static_cast<int32>(Frame.turned);
}
