// SPDX-License-Identifier: MIT
// A component that asks, each frame after the animation, which body parts of the actor's skeletal mesh penetrate each other.
#pragma once

#include "CoreMinimal.h"
#include "Components/ActorComponent.h"
#include "SpherechainSettings.h"
#include "SpherechainComponent.generated.h"

class FSpherechainCharacter;
class USkeletalMeshComponent;

USTRUCT(BlueprintType)
struct SPHERECHAIN_API FSpherechainPenetration
{
	GENERATED_BODY()

	/** The body part, and the one that it is inside of. */
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	FString Part;
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	FString Other;

	/** How deep, in the mesh component's units: centimetres. */
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	float Depth = 0.0f;

	/** The deepest point, in the world. */
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	FVector Position = FVector::ZeroVector;

	/** If this bone moves along this vector of the world, the part is free. */
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	FName Bone;
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	FVector WayOut = FVector::ZeroVector;
};

UCLASS(ClassGroup = (Animation), meta = (BlueprintSpawnableComponent))
class SPHERECHAIN_API USpherechainComponent : public UActorComponent
{
	GENERATED_BODY()

public:
	USpherechainComponent();

	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Spherechain")
	FSpherechainSettings Settings;

	/** Draws each penetration and the way out of it. */
	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Spherechain")
	bool bDraws = true;

	/** The last frame's, the worst first. */
	UPROPERTY(BlueprintReadOnly, Category = "Spherechain")
	TArray<FSpherechainPenetration> Penetrations;

	virtual void BeginPlay() override;
	virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* ThisTickFunction) override;

private:
	UPROPERTY()
	TObjectPtr<USkeletalMeshComponent> Mesh;

	TSharedPtr<FSpherechainCharacter> Character;
};
