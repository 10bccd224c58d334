// SPDX-License-Identifier: MIT
#include "SpherechainComponent.h"

#include "Components/SkeletalMeshComponent.h"
#include "DrawDebugHelpers.h"
#include "Engine/SkeletalMesh.h"
#include "GameFramework/Actor.h"
#include "SpherechainCharacter.h"
#include "SpherechainLog.h"

USpherechainComponent::USpherechainComponent()
{
	PrimaryComponentTick.bCanEverTick = true;
	PrimaryComponentTick.TickGroup = TG_PostPhysics;
}

void USpherechainComponent::BeginPlay()
{
	Super::BeginPlay();
	Mesh = GetOwner()->FindComponentByClass<USkeletalMeshComponent>();
	if (Mesh == nullptr || Mesh->GetSkeletalMeshAsset() == nullptr)
	{
		UE_LOG(LogSpherechain, Error, TEXT("%s has no skeletal mesh"), *GetOwner()->GetName());
		return;
	}
	AddTickPrerequisiteComponent(Mesh);  // its animation comes first
	Character = FSpherechainCharacter::Make(Settings, *Mesh->GetSkeletalMeshAsset());
}

void USpherechainComponent::TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* ThisTickFunction)
{
	Super::TickComponent(DeltaTime, TickType, ThisTickFunction);
	Penetrations.Reset();
	if (!Character || !Character->SetPose(Mesh->GetComponentSpaceTransforms())) return;
	const FTransform ToWorld = Mesh->GetComponentTransform();
	const spherechain::Model& Model = Character->GetModel();
	for (const spherechain::Penetration& Found : Character->Find())
	{
		FSpherechainPenetration& Out = Penetrations.AddDefaulted_GetRef();
		Out.Part = UTF8_TO_TCHAR(Model.part_name(Found.part));
		Out.Other = UTF8_TO_TCHAR(Model.part_name(Found.other));
		Out.Depth = Character->LengthToComponent(Found.measures.depth);
		Out.Position = ToWorld.TransformPosition(Character->PointToComponent(Found.deepest.position));
		if (Found.joint != SC_NO_JOINT) Out.Bone = Mesh->GetBoneName(static_cast<int32>(Found.joint));
		Out.WayOut =
		    ToWorld.TransformVector(Character->DirectionToComponent(Found.direction) * Character->LengthToComponent(Found.distance));
#if ENABLE_DRAW_DEBUG
		if (bDraws)
		{
			DrawDebugPoint(GetWorld(), Out.Position, 12.0f, FColor::Red);
			DrawDebugLine(GetWorld(), Out.Position, Out.Position + Out.WayOut, FColor::Red);
		}
#endif
	}
}
