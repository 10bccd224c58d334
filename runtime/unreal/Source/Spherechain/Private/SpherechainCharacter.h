// SPDX-License-Identifier: MIT
// A skeletal mesh and its asset: poses of Unreal in, answers in the mesh component's space out. One thread at a time.
#pragma once

#include "CoreMinimal.h"
#include "SpherechainSettings.h"
#include <spherechain/spherechain.h>

class USkeletalMesh;

class FSpherechainCharacter
{
public:
	/** Null, with the reason in the log, where the asset cannot be read or does not fit the mesh. */
	static TSharedPtr<FSpherechainCharacter> Make(const FSpherechainSettings& Settings, const USkeletalMesh& Mesh);

	/** Component-space transforms of the mesh's bones. */
	bool SetPose(const TArray<FTransform>& Bones);
	spherechain::Penetrations Find() { return Body.penetrations(); }

	/** Turns arms and hands out of the body: transforms in the parents' spaces. Returns how many bones changed. */
	int32 Respond(TArray<FTransform>& Locals, float Seconds, float Weakness);
	/** Forgets the frames before. */
	void Forget() { State = {}; }

	int32 BoneCount() const { return Parents.Num(); }
	const spherechain::Model& GetModel() const { return Model; }
	FVector PointToComponent(const sc_vec3& P) const { return DirectionToComponent(P) * Unit; }
	FVector DirectionToComponent(const sc_vec3& D) const { return FVector(Sign(0) * D.x, Sign(1) * D.y, Sign(2) * D.z); }
	float LengthToComponent(float Length) const { return Length * Unit; }

private:
	/** The mirror is a diagonal matrix of these. */
	float Sign(int32 Row) const { return Row == Turned ? -1.0f : 1.0f; }
	void ToSource(const FMatrix44f& From, float* To) const;
	spherechain::Transform ToSource(const FTransform& Local) const;

	int32 Turned = -1;  // axis: 0 is X
	float Unit = 1.0f;
	TArray<uint32> Parents;
	TArray<FMatrix44f> InverseBinds;
	TArray<float> Palette;
	TArray<spherechain::Transform> Joints;
	spherechain::Model Model;
	spherechain::Body Body;
	spherechain::Response Response;
	spherechain::ResponseState State;
};
