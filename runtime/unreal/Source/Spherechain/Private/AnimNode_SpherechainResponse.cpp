// SPDX-License-Identifier: MIT
#include "AnimNode_SpherechainResponse.h"

#include "Animation/AnimInstance.h"
#include "Animation/AnimInstanceProxy.h"
#include "Components/SkeletalMeshComponent.h"
#include "Engine/SkeletalMesh.h"
#include "ReferenceSkeleton.h"
#include "SpherechainCharacter.h"

// On the game thread, once: it reads the file.
void FAnimNode_SpherechainResponse::OnInitializeAnimInstance(const FAnimInstanceProxy* InProxy, const UAnimInstance* InAnimInstance)
{
	FAnimNode_Base::OnInitializeAnimInstance(InProxy, InAnimInstance);
	Character.Reset();
	const USkeletalMeshComponent* const Component = InAnimInstance->GetSkelMeshComponent();
	const USkeletalMesh* const Mesh = Component == nullptr ? nullptr : Component->GetSkeletalMeshAsset();
	if (Mesh == nullptr) return;
	Character = FSpherechainCharacter::Make(Settings, *Mesh);
	Locals = Mesh->GetRefSkeleton().GetRefBonePose();
}

void FAnimNode_SpherechainResponse::Initialize_AnyThread(const FAnimationInitializeContext& Context)
{
	Source.Initialize(Context);
	if (Character) Character->Forget();
	Seconds = 0.0f;
}

void FAnimNode_SpherechainResponse::CacheBones_AnyThread(const FAnimationCacheBonesContext& Context) { Source.CacheBones(Context); }

void FAnimNode_SpherechainResponse::Update_AnyThread(const FAnimationUpdateContext& Context)
{
	GetEvaluateGraphExposedInputs().Execute(Context);
	Source.Update(Context);
	Seconds += Context.GetDeltaTime();
}

void FAnimNode_SpherechainResponse::Evaluate_AnyThread(FPoseContext& Output)
{
	Source.Evaluate(Output);
	if (!Character) return;
	// A level of detail leaves bones out: they stay as in the frame before.
	const FBoneContainer& Container = Output.Pose.GetBoneContainer();
	for (const FCompactPoseBoneIndex Bone : Output.Pose.ForEachBoneIndex())
	{
		const int32 Index = Container.MakeMeshPoseIndex(Bone).GetInt();
		if (Locals.IsValidIndex(Index)) Locals[Index] = Output.Pose[Bone];
	}
	Corrected = Locals;
	const int32 Changed = Character->Respond(Corrected, Seconds, 1.0f - FMath::Clamp(Alpha, 0.0f, 1.0f));
	Seconds = 0.0f;
	if (Changed == 0) return;
	for (const FCompactPoseBoneIndex Bone : Output.Pose.ForEachBoneIndex())
	{
		const int32 Index = Container.MakeMeshPoseIndex(Bone).GetInt();
		if (Corrected.IsValidIndex(Index)) Output.Pose[Bone].SetRotation(Corrected[Index].GetRotation());
	}
}

void FAnimNode_SpherechainResponse::GatherDebugData(FNodeDebugData& DebugData)
{
	DebugData.AddDebugItem(DebugData.GetNodeName(this) + (Character ? TEXT("") : TEXT(" (no asset: see the log)")));
	Source.GatherDebugData(DebugData);
}
