// SPDX-License-Identifier: MIT
// An animation node that turns arms and hands out of the body: the last one before the output pose, after inverse kinematics.
#pragma once

#include "Animation/AnimNodeBase.h"
#include "CoreMinimal.h"
#include "SpherechainSettings.h"
#include "AnimNode_SpherechainResponse.generated.h"

class FSpherechainCharacter;

USTRUCT(BlueprintInternalUseOnly)
struct SPHERECHAIN_API FAnimNode_SpherechainResponse : public FAnimNode_Base
{
	GENERATED_BODY()

	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = Links)
	FPoseLink Source;

	UPROPERTY(EditAnywhere, Category = Settings)
	FSpherechainSettings Settings;

	/** 1: the full response; 0: none. */
	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = Settings, meta = (PinShownByDefault))
	float Alpha = 1.0f;

	virtual bool NeedsOnInitializeAnimInstance() const override { return true; }
	virtual void OnInitializeAnimInstance(const FAnimInstanceProxy* InProxy, const UAnimInstance* InAnimInstance) override;
	virtual void Initialize_AnyThread(const FAnimationInitializeContext& Context) override;
	virtual void CacheBones_AnyThread(const FAnimationCacheBonesContext& Context) override;
	virtual void Update_AnyThread(const FAnimationUpdateContext& Context) override;
	virtual void Evaluate_AnyThread(FPoseContext& Output) override;
	virtual void GatherDebugData(FNodeDebugData& DebugData) override;

private:
	TSharedPtr<FSpherechainCharacter> Character;
	TArray<FTransform> Locals, Corrected;  // the mesh's bones in their parents' spaces, as animated and after
	float Seconds = 0.0f;                  // since the last evaluation
};
