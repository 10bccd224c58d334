// SPDX-License-Identifier: MIT
// The asset of a character, and how Unreal's importer changed its axes and unit. The component and the animation node have one each.
#pragma once

#include "CoreMinimal.h"
#include "Engine/EngineTypes.h"
#include "SpherechainSettings.generated.h"

USTRUCT(BlueprintType)
struct SPHERECHAIN_API FSpherechainSettings
{
	GENERATED_BODY()

	/** A file that `spherechain bake` wrote, absolute or below the project's Content folder. Add its folder to "Additional
	 * Non-Asset Directories to Package". */
	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Spherechain")
	FString Asset;

	/** The axis that the importer turned around. Unreal's FBX importer turns Y. */
	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Spherechain")
	TEnumAsByte<EAxis::Type> MirroredAxis = EAxis::Y;

	/** Length of a unit of the baked file here: 100 where the file is in metres, 1 where it is in centimetres. */
	UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Spherechain")
	float SourceUnit = 1.0f;
};
